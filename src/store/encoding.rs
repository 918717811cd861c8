//! Serde values as bytes: the one place that calls bincode.
//!
//! bincode 2.0.1 in its legacy configuration (fixed-width little-endian integers, u64 lengths). Without a limit a
//! damaged length would ask for the memory of the whole machine; decoding is done after the checksum, too.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// No value in a store is larger than this when encoded, bytes.
const LIMIT: usize = 1 << 30;

/// Encodes a value.
pub fn encode<T: Serialize>(value: &T) -> Result<Vec<u8>, String> {
    bincode::serde::encode_to_vec(value, config()).map_err(|e| e.to_string())
}

/// Decodes a value that takes up all of `bytes`.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let (value, used) = bincode::serde::decode_from_slice(bytes, config()).map_err(|e| e.to_string())?;
    if used == bytes.len() { Ok(value) } else { Err(format!("{} bytes left over", bytes.len() - used)) }
}

fn config() -> impl bincode::config::Config {
    bincode::config::legacy().with_limit::<LIMIT>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_survives_and_left_over_bytes_are_an_error() {
        let mut bytes = encode(&vec!["a".to_owned(), "bc".to_owned()]).unwrap();
        assert_eq!(bytes.len(), 8 + 8 + 1 + 8 + 2);
        assert_eq!(decode::<Vec<String>>(&bytes).unwrap(), ["a", "bc"]);
        bytes.push(0);
        assert!(decode::<Vec<String>>(&bytes).unwrap_err().contains("left over"));
    }

    #[test]
    fn a_damaged_length_is_an_error_not_an_allocation() {
        assert!(decode::<Vec<u8>>(&[0xff; 16]).is_err());
        assert!(decode::<Vec<[u64; 4]>>(&(1u64 << 60).to_le_bytes()).is_err());
    }
}
