//! Units of a representation: millimetres in its length unit, radians in its angle unit.

use super::keyword::Kind;
use super::records::{File, Record};
use crate::stages::parse::fault::Read;

/// How often a conversion-based unit may rest on another one.
const DEEPEST_CONVERSION: usize = 8;

/// Factors from the numbers of a file to mm and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Units {
    pub length: f64,
    pub angle: f64,
}

impl Default for Units {
    /// What a file without units is taken to mean.
    fn default() -> Self {
        Self { length: 1.0, angle: 1.0 }
    }
}

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Unit {
    /// Factor to mm.
    Length(f64),
    /// Factor to radians.
    Angle(f64),
    Neither,
}

/// The units of a representation context; what it does not tell is in mm and radians.
pub(super) fn units_of_context(file: &File, context: u64) -> Units {
    let mut units = Units::default();
    let Ok(record) = file.record(context) else { return units };
    let Some(mut cursor) = record.part(Kind::GlobalUnitAssignedContext) else { return units };
    if record.kind != Kind::Complex {
        cursor.skip_many(2);
    }
    for id in cursor.references_leniently().unwrap_or_default() {
        match unit(file, id, 0) {
            Ok(Unit::Length(factor)) => units.length = factor,
            Ok(Unit::Angle(factor)) => units.angle = factor,
            _ => {}
        }
    }
    units
}

fn unit(file: &File, id: u64, depth: usize) -> Read<Unit> {
    let record = file.record(id)?;
    let found = if record.is(Kind::SiUnit) {
        si_unit(&record)
    } else if record.is(Kind::ConversionBasedUnit) && depth < DEEPEST_CONVERSION {
        conversion(file, &record, depth)?
    } else {
        Unit::Neither
    };
    match found {
        Unit::Length(f) | Unit::Angle(f) if !f.is_normal() || f < 0.0 => Err(record.fault("a unit without a size")),
        found => Ok(found),
    }
}

/// The factor of CONVERSION_BASED_UNIT, whatever its name says.
fn conversion(file: &File, record: &Record, depth: usize) -> Read<Unit> {
    let mut cursor = record.fields(&[Kind::ConversionBasedUnit]);
    if record.kind != Kind::Complex {
        cursor.skip();
    }
    let measure = file.record(cursor.skip_many(1).reference()?)?;
    let mut cursor = measure.fields(&[Kind::MeasureWithUnit]);
    let factor = cursor.real()?;
    Ok(match unit(file, cursor.reference()?, depth + 1)? {
        Unit::Length(base) => Unit::Length(base * factor),
        Unit::Angle(base) => Unit::Angle(base * factor),
        Unit::Neither => Unit::Neither,
    })
}

/// SI_UNIT has a prefix and a name; as a simple instance the dimensions, `*`, come first.
fn si_unit(record: &Record) -> Unit {
    let mut cursor = record.fields(&[Kind::SiUnit]);
    if record.kind != Kind::Complex {
        cursor.skip();
    }
    let factor = prefix(cursor.word());
    match cursor.word() {
        name if name.eq_ignore_ascii_case(b"METRE") => Unit::Length(1000.0 * factor),
        name if name.eq_ignore_ascii_case(b"RADIAN") => Unit::Angle(factor),
        _ => Unit::Neither,
    }
}

/// The factor of an SI prefix; 1 without one.
fn prefix(name: &[u8]) -> f64 {
    match name.to_ascii_uppercase().as_slice() {
        b"EXA" => 1e18,
        b"PETA" => 1e15,
        b"TERA" => 1e12,
        b"GIGA" => 1e9,
        b"MEGA" => 1e6,
        b"KILO" => 1e3,
        b"HECTO" => 1e2,
        b"DECA" => 1e1,
        b"DECI" => 1e-1,
        b"CENTI" => 1e-2,
        b"MILLI" => 1e-3,
        b"MICRO" => 1e-6,
        b"NANO" => 1e-9,
        b"PICO" => 1e-12,
        b"FEMTO" => 1e-15,
        b"ATTO" => 1e-18,
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancel::Cancel;
    use crate::stages::parse::step::lexer::scan;

    fn units(text: &str) -> Units {
        let table = scan(text.as_bytes(), &Cancel::new()).unwrap();
        units_of_context(&File { bytes: text.as_bytes(), table: &table }, 1)
    }

    #[test]
    fn inches_and_degrees_are_followed_to_their_factors() {
        let found = units(
            "#1=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#2,#3))REPRESENTATION_CONTEXT('',''));
             #2=(CONVERSION_BASED_UNIT('FURLONG',#4)LENGTH_UNIT()NAMED_UNIT(#9));
             #3=(CONVERSION_BASED_UNIT('DEGREE',#5)NAMED_UNIT(#9)PLANE_ANGLE_UNIT());
             #4=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(2.54),#6);#5=PLANE_ANGLE_MEASURE_WITH_UNIT(0.0174532925,#7);
             #6=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));#7=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));",
        );
        assert!((found.length - 25.4).abs() < 1e-12);
        assert_eq!(found.angle, 0.0174532925);
    }

    #[test]
    fn a_unit_made_of_itself_is_left_out() {
        let found = units(
            "#1=GLOBAL_UNIT_ASSIGNED_CONTEXT('','',(#2));#2=(CONVERSION_BASED_UNIT('X',#3)NAMED_UNIT(*));
             #3=MEASURE_WITH_UNIT(LENGTH_MEASURE(2.),#2);",
        );
        assert_eq!(found, Units::default());
    }
}
