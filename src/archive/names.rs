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
    inputs
        .iter()
        .map(name)
        .map(|name| {
            let numbered = (2..).map(|n| format!("{name}~{n}"));
            let mut names = std::iter::once(name.clone()).chain(numbered);
            let free = names.find(|name| taken.insert(name.clone())).unwrap_or(name);
            format!("{free}/")
        })
        .collect()
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
    fn member_names_are_tidied() {
        assert_eq!(cleaned("./usr//share/x.step"), "usr/share/x.step");
        assert_eq!(cleaned("/etc/x.step"), "etc/x.step");
        assert_eq!(cleaned("../x.step"), "../x.step");
        assert_eq!(cleaned("dir\\x.step"), "dir/x.step");
    }
}
