//! Princeton classifications (`.cla`): `PSB 1`, the numbers of classes and models, then for each class its name, its
//! parent's (`0`: none) and its number of models, followed by their ids; all tokens, divided by any white space.
//!
//! Inner classes may own models; models are relevant to each other within one class, not within its parent.

use super::super::Gallery;
use super::super::gallery::MISCELLANEOUS;
use super::{token, untoken};
use std::collections::BTreeSet;
use std::io::Write;

/// The (id, class) pairs of a classification in their order, which is that of the rows of a matrix beside it.
/// Models of the class `-1` and of classes below it are miscellaneous.
///
/// # Errors
/// What is wrong, in words.
pub fn read(text: &str) -> Result<Vec<(String, String)>, String> {
    let mut tokens = text.split_whitespace();
    let mut next = |what: &str| tokens.next().ok_or(format!("it ends where {what} should be"));
    if (next("`PSB`")?, next("the version")?) != ("PSB", "1") {
        return Err("it does not begin with `PSB 1`".into());
    }
    let (classes, models) = (number(next("the number of classes")?)?, number(next("the number of models")?)?);
    let (mut names, mut miscellaneous) = (BTreeSet::from(["0"]), BTreeSet::from([MISCELLANEOUS]));
    let mut pairs = Vec::new();
    for _ in 0..classes {
        let (name, parent) = (next("a class")?, next("its parent")?);
        if !names.contains(parent) && parent != MISCELLANEOUS {
            return Err(format!("the class {name} comes before its parent {parent}"));
        }
        if !names.insert(name) {
            return Err(format!("there are two classes {name}"));
        }
        if miscellaneous.contains(parent) {
            miscellaneous.insert(name);
        }
        let category = if miscellaneous.contains(name) { MISCELLANEOUS } else { name };
        for _ in 0..number(next("the number of its models")?)? {
            pairs.push((untoken(next("a model")?), untoken(category)));
        }
    }
    if pairs.len() != models || tokens.next().is_some() {
        return Err(format!("it promises {models} models and holds {} and perhaps more", pairs.len()));
    }
    Ok(pairs)
}

fn number(token: &str) -> Result<usize, String> {
    token.parse().map_err(|_| format!("`{token}` is not a number"))
}

/// Writes the gallery's classes in its order, without hierarchy.
pub fn write(gallery: &Gallery, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(out, "PSB 1\n{} {}", gallery.classes.len(), gallery.len())?;
    for class in &gallery.classes {
        writeln!(out, "\n{} 0 {}", token(&class.name), class.size())?;
        class.members.clone().try_for_each(|i| writeln!(out, "{}", token(&gallery.ids[i])))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::super::gallery::tests::gallery;
    use super::*;

    const NESTED: &str =
        "PSB 1\n4 6\n\naircraft 0 1\n11\n\nbiplane aircraft 2\n12\n13\n\n-1 0 1\n14\nodd -1 2\n15 16\n";

    #[test]
    fn inner_classes_own_models_and_miscellaneous_ones_have_none() {
        let pairs = read(NESTED).unwrap();
        let classes: Vec<_> = pairs.iter().map(|(id, class)| format!("{id} {class}")).collect();
        assert_eq!(classes, ["11 aircraft", "12 biplane", "13 biplane", "14 -1", "15 -1", "16 -1"]);
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (from, to, why) in [
            ("PSB 1", "PSB 2", "begin"),
            ("4 6", "4 7", "promises"),
            ("4 6", "3 4", "more"),
            ("biplane aircraft", "biplane bird", "parent"),
            ("biplane aircraft", "aircraft 0", "two"),
            ("0 1\n11", "0 one\n11", "number"),
            ("15 16", "15", "ends"),
        ] {
            let error = read(&NESTED.replacen(from, to, 1)).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
        // a count that lies must not reserve memory
        assert!(read("PSB 1\n1 18446744073709551615\na 0 18446744073709551615\nx").is_err());
    }

    #[test]
    fn a_gallery_comes_back() {
        let gallery = gallery(&["air plane", "air plane", "car"]);
        let mut text = Vec::new();
        write(&gallery, &mut text).unwrap();
        let pairs = read(std::str::from_utf8(&text).unwrap()).unwrap();
        assert_eq!(pairs[1], ("m0001".into(), "air plane".into()));
        assert_eq!(pairs.len(), 3);
    }
}
