//! Which settings differ between two stores, or a store and a run.

use toml::{Table, Value};

/// The keys whose values differ between two settings texts, each as `key: left, right`; sorted by key.
pub fn differences(left: &str, right: &str) -> Vec<String> {
    match (left.parse::<Table>(), right.parse::<Table>()) {
        (Ok(left), Ok(right)) => {
            let mut found = Vec::new();
            compare("", &left, &right, &mut found);
            found
        }
        _ => vec!["one of the settings texts is not TOML".into()],
    }
}

fn compare(prefix: &str, left: &Table, right: &Table, found: &mut Vec<String>) {
    let mut keys: Vec<&String> = left.keys().chain(right.keys()).collect();
    keys.sort_unstable();
    keys.dedup();
    for key in keys {
        match (left.get(key), right.get(key)) {
            (Some(Value::Table(a)), Some(Value::Table(b))) => compare(&format!("{prefix}{key}."), a, b, found),
            (a, b) if a != b => found.push(format!("{prefix}{key}: {}, {}", shown(a), shown(b))),
            _ => {}
        }
    }
}

fn shown(value: Option<&Value>) -> String {
    value.map_or("not set".into(), Value::to_string)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differing_keys_are_named_with_both_values() {
        let left = "a = 1\nsame = true\n[stage]\nx = 0.5\ny = 2";
        let right = "a = 2\nsame = true\n[stage]\nx = 0.25\ny = 2\nz = \"new\"";
        let expected = ["a: 1, 2", "stage.x: 0.5, 0.25", "stage.z: not set, \"new\""];
        assert_eq!(differences(left, right), expected);
        assert!(differences(left, left).is_empty());
    }
}
