//! What a file is, by its name.

/// How a file is compressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Packing {
    #[default]
    Plain,
    Gzip,
    Xz,
    Zstd,
}

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A single model.
    Model(Packing),
    /// A tar archive, packed or not.
    Tar(Packing),
    /// A .zip archive.
    Zip,
    /// A .7z archive.
    SevenZip,
}

const MODELS: [&str; 7] = [".step", ".stp", ".p21", ".igs", ".iges", ".brep", ".brp"];
/// Compressed single files (ISO 10303-21 edition 3 names `.stpz`; they hold gzip or zip data).
const PACKED_MODELS: [&str; 3] = [".stepz", ".stpz", ".p21z"];
const PACKINGS: [(&str, Packing); 3] = [(".gz", Packing::Gzip), (".xz", Packing::Xz), (".zst", Packing::Zstd)];
const TARS: [(&str, Packing); 4] =
    [(".tar", Packing::Plain), (".tgz", Packing::Gzip), (".txz", Packing::Xz), (".tzst", Packing::Zstd)];

/// What the file called `name` (a path or an id) is; `None`: nothing for us. Case does not matter. The companions
/// that macOS leaves beside files (`._name`, `__MACOSX/`) are nothing for us.
pub fn kind_of(name: &str) -> Option<Kind> {
    let name = name.to_ascii_lowercase();
    let base = name.rsplit(['/', '!']).next().unwrap_or(&name);
    if base.starts_with("._") || name.contains("__macosx/") {
        return None;
    }
    let ends = |suffixes: &[&str]| suffixes.iter().any(|suffix| base.ends_with(suffix));
    if ends(&MODELS) {
        return Some(Kind::Model(Packing::Plain));
    }
    if ends(&PACKED_MODELS) {
        return Some(Kind::Model(Packing::Gzip));
    }
    if ends(&[".zip"]) {
        return Some(Kind::Zip);
    }
    if ends(&[".7z"]) {
        return Some(Kind::SevenZip);
    }
    TARS.iter()
        .find(|(suffix, _)| base.ends_with(suffix))
        .map(|(_, packing)| Kind::Tar(*packing))
        .or_else(|| packed(base))
}

/// A compressed tar or model.
fn packed(base: &str) -> Option<Kind> {
    let (inner, packing) = PACKINGS.iter().find_map(|(suffix, p)| Some((base.strip_suffix(suffix)?, *p)))?;
    match kind_of(inner)? {
        Kind::Tar(Packing::Plain) => Some(Kind::Tar(packing)),
        Kind::Model(Packing::Plain) => Some(Kind::Model(packing)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_kinds_in_any_case() {
        let cases = [
            ("a/Part.STEP", Some(Kind::Model(Packing::Plain))),
            ("x.stp", Some(Kind::Model(Packing::Plain))),
            ("x.p21", Some(Kind::Model(Packing::Plain))),
            ("x.IGS", Some(Kind::Model(Packing::Plain))),
            ("x.iges.xz", Some(Kind::Model(Packing::Xz))),
            ("x.brep", Some(Kind::Model(Packing::Plain))),
            ("x.brp.gz", Some(Kind::Model(Packing::Gzip))),
            ("x.stpZ", Some(Kind::Model(Packing::Gzip))),
            ("x.step.gz", Some(Kind::Model(Packing::Gzip))),
            ("x.tar", Some(Kind::Tar(Packing::Plain))),
            ("x.tar.gz", Some(Kind::Tar(Packing::Gzip))),
            ("x.TGZ", Some(Kind::Tar(Packing::Gzip))),
            ("x.tar.xz", Some(Kind::Tar(Packing::Xz))),
            ("x.tar.zst", Some(Kind::Tar(Packing::Zstd))),
            ("x.zip", Some(Kind::Zip)),
            ("x.7z", Some(Kind::SevenZip)),
            ("x.step.bak", None),
            ("x.stl.gz", None),
            ("step", None),
            ("a/._x.step", None),
            ("__MACOSX/x.step", None),
        ];
        for (name, kind) in cases {
            assert_eq!(kind_of(name), kind, "{name}");
        }
    }
}
