//! Reading within a time, and files to be read.

use std::sync::mpsc;
use std::time::Duration;

use symalign::cancel::Cancel;
use symalign::stages::ModelError;
use symalign::stages::parse::{Options, Parsed, parse};

/// Far more than any text in these tests takes, and far less than quadratic time would be.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A solid cylinder of radius 2 mm and height 5 mm: #17 is its wall, #50 its top, #59 its bottom.
pub const CYLINDER: &str = include_str!("../../fuzz/seeds/cylinder.step");

/// Reads bytes; fails the test where that does not end.
pub fn parsed(bytes: impl Into<Vec<u8>>) -> Result<Parsed, ModelError> {
    parsed_until(bytes, &Cancel::new(), PATIENCE)
}

/// Reads bytes, which must end within a time.
pub fn parsed_until(bytes: impl Into<Vec<u8>>, cancel: &Cancel, patience: Duration) -> Result<Parsed, ModelError> {
    let (bytes, cancel) = (bytes.into(), cancel.clone());
    let (send, receive) = mpsc::channel();
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(300)]).into_owned();
    let reader = std::thread::spawn(move || send.send(parse(&bytes, &Options::default(), None, &cancel)).is_ok());
    let result = match receive.recv_timeout(patience) {
        Ok(result) => result,
        Err(mpsc::RecvTimeoutError::Timeout) => panic!("not read within {patience:?}: {start}"),
        Err(mpsc::RecvTimeoutError::Disconnected) => panic!("a panic while reading: {start}"),
    };
    assert!(reader.join().expect("it has sent its result"));
    if let Err(error) = &result {
        assert!(!error.why.is_empty(), "{start}");
    }
    result
}

/// The cylinder with one instance written otherwise.
pub fn with(instance: &str) -> String {
    let number = &instance[..=instance.find('=').expect("an instance has a number")];
    let start = CYLINDER.find(&format!("\n{number}")).expect("the cylinder has the instance") + 1;
    let end = start + CYLINDER[start..].find('\n').expect("each instance has its line");
    format!("{}{instance}{}", &CYLINDER[..start], &CYLINDER[end..])
}

/// The cylinder with more instances.
pub fn and(more: &str) -> String {
    CYLINDER.replace("ENDSEC;END-ISO", &format!("{more}ENDSEC;END-ISO"))
}

/// The entities that were left out, with their reasons, and the number of faces that are there.
pub fn left_out(text: impl Into<Vec<u8>>) -> (usize, Vec<(u64, String)>) {
    let parsed = parsed(text).expect("something is there");
    (parsed.mesh.faces.len(), parsed.skipped.into_iter().map(|s| (s.entity, s.why)).collect())
}
