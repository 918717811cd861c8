//! Journals torn and damaged at every byte.

use super::*;
use crate::stages::Stage;

/// Bytes of a record of the settings "a = 1".
const SETTINGS_LENGTH: usize = HEAD + 4 + 5;

fn lost(why: &str) -> Outcome {
    Err(ModelError::new(Stage::Parse, why))
}

/// Three lost models with the hashes [1; 32], [2; 32], [3; 32].
fn journal(dir: &Path) -> PathBuf {
    let path = dir.join("journal");
    let mut journal = Journal::create(&path, "a = 1").unwrap();
    for i in 1..=3 {
        journal.append(&[i; 32], &lost(&format!("reason {i}"))).unwrap();
    }
    journal.commit().unwrap();
    path
}

fn known(journal: &Journal) -> Vec<u8> {
    (1..=3).filter(|i| journal.outcome(&[*i; 32]).unwrap() == Some(lost(&format!("reason {i}")))).collect()
}

#[test]
fn outcomes_survive_and_the_last_one_counts() {
    let dir = tempfile::tempdir().unwrap();
    let (mut journal, settings) = Journal::open(&journal(dir.path())).unwrap().unwrap();
    assert_eq!((settings.as_str(), known(&journal)), ("a = 1", vec![1, 2, 3]));
    journal.append(&[1; 32], &lost("again")).unwrap();
    assert_eq!(journal.outcome(&[1; 32]).unwrap(), Some(lost("again")));
    assert_eq!((journal.len(), journal.knows(&[1; 32]), journal.knows(&[9; 32])), (3, Some(false), None));
}

#[test]
fn a_tail_torn_at_any_byte_is_cut_off_and_told() {
    let dir = tempfile::tempdir().unwrap();
    let path = journal(dir.path());
    let whole = std::fs::read(&path).unwrap();
    let head = 2 * SETTINGS_LENGTH;
    let record = (whole.len() - head) / 3;
    for length in SETTINGS_LENGTH..whole.len() {
        std::fs::write(&path, &whole[..length]).unwrap();
        let records = length.saturating_sub(head) / record;
        let kept = if length < head { SETTINGS_LENGTH } else { head + records * record };
        let (journal, _) = Journal::open(&path).unwrap().unwrap();
        let damage: Vec<_> = journal.damage().iter().map(|d| (d.offset, d.length)).collect();
        let torn = (kept < length).then_some((kept as u64, (length - kept) as u64));
        assert_eq!((journal.len(), damage), (records, Vec::from_iter(torn)), "at {length}");
        drop(journal);
        assert_eq!(std::fs::read(&path).unwrap(), whole[..kept]);
    }
}

#[test]
fn every_flipped_bit_is_found_and_costs_one_record() {
    let dir = tempfile::tempdir().unwrap();
    let path = journal(dir.path());
    assert_eq!(Journal::verify(&path).unwrap(), (3, Vec::new()));
    let whole = std::fs::read(&path).unwrap();
    let head = 2 * SETTINGS_LENGTH;
    let record = (whole.len() - head) / 3;
    for bit in 0..whole.len() * 8 {
        let mut bytes = whole.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        std::fs::write(&path, &bytes).unwrap();
        let (models, damage) = Journal::verify(&path).unwrap();
        let hit = (bit / 8).checked_sub(head).map(|at| at / record);
        let offset = hit.map_or(bit / 8 / SETTINGS_LENGTH * SETTINGS_LENGTH, |hit| head + hit * record);
        assert_eq!(damage.iter().map(|d| d.offset).collect::<Vec<_>>(), [offset as u64], "bit {bit}");
        let (journal, settings) = Journal::open(&path).unwrap().unwrap();
        let left: Vec<u8> = (1..=3).filter(|i| hit != Some(usize::from(*i) - 1)).collect();
        assert_eq!((settings.as_str(), models, known(&journal)), ("a = 1", left.len(), left), "bit {bit}");
        assert_eq!((journal.damage(), Journal::verify(&path).unwrap().1), (&damage[..], Vec::new()), "bit {bit}");
    }
}

#[test]
fn another_version_is_refused_with_what_to_do() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("journal");
    let made = [&(VERSION + 1).to_le_bytes()[..], b"a = 1"].concat();
    std::fs::write(&path, record(SETTINGS, &made)).unwrap();
    let error = Journal::open(&path).unwrap_err().to_string();
    assert!(error.contains(&format!("format version {}", VERSION + 1)) && error.contains("--fresh"), "{error}");
    assert_eq!(Journal::verify(&path).unwrap_err().to_string(), error);
}

#[test]
fn a_journal_that_could_not_be_filled_is_not_there() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("journal");
    let full = || RunError::file("journal", std::io::Error::other("no space left"));
    assert!(Journal::create_with(&path, "a = 1", &mut |_| Err(full())).is_err());
    assert!(Journal::open(&path).unwrap().is_none());
}

#[test]
fn one_damaged_copy_of_the_settings_loses_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let path = journal(dir.path());
    let whole = std::fs::read(&path).unwrap();
    for copy in [0, SETTINGS_LENGTH] {
        let mut bytes = whole.clone();
        bytes[copy + HEAD] ^= 1;
        std::fs::write(&path, &bytes).unwrap();
        let (journal, settings) = Journal::open(&path).unwrap().unwrap();
        assert_eq!((settings.as_str(), known(&journal)), ("a = 1", vec![1, 2, 3]));
    }
    let mut bytes = whole.clone();
    bytes[HEAD] ^= 1;
    bytes[SETTINGS_LENGTH + HEAD] ^= 1;
    std::fs::write(&path, &bytes).unwrap();
    assert!(Journal::open(&path).unwrap_err().to_string().contains("settings"));
}
