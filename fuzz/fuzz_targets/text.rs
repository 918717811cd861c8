//! Raw bytes -> the B-rep of a file: what the lexer, the records and the readers make of anything.
#![no_main]

use libfuzzer_sys::fuzz_target;
use symalign::cancel::Cancel;
use symalign::stages::parse::{Options, read};

fuzz_target!(|bytes: &[u8]| {
    let _ = read(bytes, &Options::default(), &Cancel::new());
});
