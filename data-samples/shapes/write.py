"""STEP files: schema, unit and structure chosen per file, bytes that depend on the geometry only."""

import itertools
import re

from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import (STEPControl_AsIs, STEPControl_Controller, STEPControl_Reader, STEPControl_Writer)
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFDoc import XCAFDoc_DocumentTool

SCHEMAS = {"AP203": "AP203", "AP214": "AP214IS", "AP242": "AP242DIS"}
UNITS = {"mm": "MM", "cm": "CM", "m": "M", "inch": "INCH"}
STAMP = "2026-01-01T00:00:00"

Message.DefaultMessenger_s().ChangePrinters().Clear()  # the kernel reports every transfer on standard output


def prepare(schema, unit, pcurves):
    """Sets the writer's static parameters."""
    STEPControl_Controller.Init_s()
    Interface_Static.SetCVal_s("write.step.schema", SCHEMAS[schema])
    Interface_Static.SetCVal_s("write.step.unit", UNITS[unit])
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 1 if pcurves else 0)
    Interface_Static.SetCVal_s("write.step.product.name", "model")


def write_shape(shape, path, schema, unit, pcurves):
    """Writes one shape (a solid, or a compound of solids) in mm."""
    prepare(schema, unit, pcurves)
    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_AsIs)
    if writer.Write(str(path)) != IFSelect_RetDone:
        raise OSError(f"{path}: not written")
    settle(path)


def name(label, text):
    """Names an entry of the document."""
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(text))


def write_assembly(parts, pose, nested, path, schema, unit, pcurves):
    """Writes (name, solid, placements) as an assembly; `nested` puts the pose on one sub-assembly of the root."""
    prepare(schema, unit, pcurves)
    document = TDocStd_Document(TCollection_ExtendedString("MDTV-XCAF"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, 0.001)
    root = tool.NewShape()
    name(root, path.stem)
    holder = root
    if nested:
        holder = tool.NewShape()
        name(holder, "body")
        tool.AddComponent(root, holder, TopLoc_Location(pose))
    for title, solid, places in parts:
        component = tool.AddShape(solid, False)
        name(component, title)
        for place in places:
            tool.AddComponent(holder, component, TopLoc_Location(place if nested else pose.Multiplied(place)))
    tool.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.Transfer(document, STEPControl_AsIs)
    if writer.Write(str(path)) != IFSelect_RetDone:
        raise OSError(f"{path}: not written")
    settle(path)


def settle(path):
    """Replaces everything in the file that depends on the clock, the machine or the run."""
    text = path.read_text(encoding="ascii", errors="replace")
    title = f"FILE_NAME('{path.name}','{STAMP}',('symalign'),(''),'data-samples','data-samples','');"
    text = re.sub(r"FILE_NAME\(.*?\);", title, text, count=1, flags=re.S)
    text = re.sub(r"CALENDAR_DATE\([^)]*\)", "CALENDAR_DATE(2026,1,1)", text)
    text = re.sub(r"LOCAL_TIME\(\d+,\d+,[^,]*,", "LOCAL_TIME(0,0,0.,", text)
    text = re.sub(r"COORDINATED_UNIVERSAL_TIME_OFFSET\([^)]*\)", "COORDINATED_UNIVERSAL_TIME_OFFSET(0,0,.AHEAD.)", text)
    text = re.sub(r"PERSON\('[^;]*;", "PERSON('symalign','','symalign',$,$,$);", text)
    text = re.sub(r" ORGANIZATION\('[^;]*;", " ORGANIZATION('symalign','Unspecified','');", text)
    text = re.sub(r"#\d+ = [^;]*?(?:'model \d|OCCURRENCE\()[^;]*;", lambda found: re.sub(r"\n\s*", "", found.group()), text)
    text = re.sub(r"'model \d+((?:\.\d+)*)'", rf"'{path.stem}\1'", text)  # the kernel numbers products in one count
    count = itertools.count(1)
    text = re.sub(r"USAGE_OCCURRENCE\('\d+'", lambda _: f"USAGE_OCCURRENCE('{next(count)}'", text)
    path.write_text(text, encoding="ascii", newline="\n")


def read(path):
    """The shape of a STEP file, in mm."""
    reader = STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        raise OSError(f"{path}: not read")
    reader.TransferRoots()
    return reader.OneShape()
