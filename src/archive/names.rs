//! Ids: a model's path inside its input, with `/` between the parts.

use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};

/// What the ids of each input start with: nothing for a single input, else the input's own name, made unique.
pub fn prefixes(inputs: &[PathBuf]) -> Vec<String> {
    if inputs.len() == 1 {
        return vec![String::new()];
    }
    let mut taken = HashSet::new();
    let name =
        |input: &PathBuf| input.file_name().map_or_else(|| "-".into(), |name| name.to_string_lossy().into_owned());
    inputs.iter().map(|input| format!("{}/", unique(name(input), &mut taken))).collect()
}

/// A name, with a number where it is taken already; then it is taken.
pub fn unique(name: String, taken: &mut HashSet<String>) -> String {
    let numbered = (2..).map(|n| format!("{name}~{n}"));
    let mut names = std::iter::once(name.clone()).chain(numbered);
    names.find(|name| taken.insert(name.clone())).unwrap_or(name)
}

/// The path of a file inside a folder.
pub fn inside(folder: &Path, path: &Path) -> String {
    let relative = path.strip_prefix(folder).unwrap_or(path);
    let parts = relative.components().map(|part| part.as_os_str().to_string_lossy());
    parts.collect::<Vec<_>>().join("/")
}

/// The name of an archive's member without empty parts, `.` and leading separators; `..` stays, it is only a name.
pub fn cleaned(name: &str) -> String {
    let name = name.replace('\\', "/");
    let parts = Path::new(&name).components().filter_map(|part| match part {
        Component::Normal(part) => Some(part.to_string_lossy().into_owned()),
        Component::ParentDir => Some("..".to_owned()),
        _ => None,
    });
    parts.collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_inputs_get_distinct_prefixes() {
        let inputs = ["a/parts", "b/parts", "x.zip"].map(PathBuf::from);
        assert_eq!(prefixes(&inputs), ["parts/", "parts~2/", "x.zip/"]);
        assert_eq!(prefixes(&inputs[..1]), [""]);
    }

    #[test]
    fn a_name_met_again_gets_a_number() {
        let mut taken = HashSet::new();
        let named = ["a", "b", "a", "a", "a~2"].map(|name| unique(name.to_owned(), &mut taken));
        assert_eq!(named, ["a", "b", "a~2", "a~3", "a~2~2"]);
    }

    #[test]
    fn member_names_are_tidied() {
        assert_eq!(cleaned("./usr//share/x.step"), "usr/share/x.step");
        assert_eq!(cleaned("/etc/x.step"), "etc/x.step");
        assert_eq!(cleaned("../x.step"), "../x.step");
        assert_eq!(cleaned("dir\\x.step"), "dir/x.step");
    }
}
