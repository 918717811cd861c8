//! The header: only the schema matters.

use super::records::File;

const LONGEST_NAME: usize = 400;

/// The first name of FILE_SCHEMA in upper case without its object identifier; empty where there is none.
pub(super) fn schema(file: &File) -> String {
    let Some(start) = file.table.schema else { return String::new() };
    let quoted = file.bytes[start..].split(|b| *b == b';').next().unwrap_or_default();
    let name = quoted.split(|b| *b == b'\'').nth(1).unwrap_or_default();
    // No schema has such a long name: a giant string is not copied.
    let text = String::from_utf8_lossy(&name[..name.len().min(LONGEST_NAME)]);
    let word = text.split(['{', ' ']).find(|w| !w.is_empty()).unwrap_or_default();
    word.chars().take(100).collect::<String>().to_uppercase()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancel::Cancel;
    use crate::stages::parse::step::lexer::scan;

    #[test]
    fn the_schema_name_comes_without_its_identifier() {
        let text = b"HEADER;FILE_SCHEMA (( 'Automotive_Design { 1 0 10303 214 }'));ENDSEC;";
        let table = scan(text, &Cancel::new()).unwrap();
        assert_eq!(schema(&File { bytes: text, table: &table }), "AUTOMOTIVE_DESIGN");
    }
}
