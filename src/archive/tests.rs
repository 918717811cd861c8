use std::io::Write;

use super::*;

const LIMITS: Limits = Limits { bytes: 100, expansion: 100 };

/// All ids with their bytes as text, failures as `!reason`.
fn all(inputs: &[PathBuf]) -> Vec<(String, String)> {
    let mut found = Vec::new();
    visit(inputs, &LIMITS, &no_wait, &mut |member| {
        let text = match member.bytes {
            Ok(bytes) => String::from_utf8(bytes).unwrap(),
            Err(why) => format!("!{why}"),
        };
        found.push((member.id, text));
        // What is in the memory that the next member is read into must not show.
        ControlFlow::Continue(b"of another model".to_vec())
    })
    .unwrap();
    found
}

fn pairs(expected: &[(&str, &str)]) -> Vec<(String, String)> {
    expected.iter().map(|(id, text)| ((*id).to_owned(), (*text).to_owned())).collect()
}

fn tar_of(members: &[(&str, &str)]) -> Vec<u8> {
    let mut builder = tar::Builder::new(Vec::new());
    for (name, text) in members {
        let mut header = tar::Header::new_gnu();
        header.set_size(text.len() as u64);
        let field = &mut header.as_old_mut().name;
        field[..name.len()].copy_from_slice(name.as_bytes());
        header.set_cksum();
        builder.append(&header, text.as_bytes()).unwrap();
    }
    builder.into_inner().unwrap()
}

fn zip_of(members: &[(&str, &str)]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, text) in members {
        writer.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        writer.write_all(text.as_bytes()).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn xz(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = liblzma::write::XzEncoder::new(Vec::new(), 1);
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

const MEMBERS: [(&str, &str); 4] =
    [("./a/x.step", "one"), ("../y.STP", "two"), ("/z.p21", "three"), ("note.txt", "no")];

#[test]
fn a_folder_is_visited_in_the_order_of_names() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("b")).unwrap();
    for (name, text) in [("b/x.step", "1"), ("a.stp", "2"), ("c.P21", "3"), ("d.txt", "4")] {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    std::fs::write(dir.path().join("e.stpZ"), gzip(b"5")).unwrap();
    std::fs::write(dir.path().join("f.stpZ"), zip_of(&[("f.stp", "6")])).unwrap();
    let expected = [("a.stp", "2"), ("b/x.step", "1"), ("c.P21", "3"), ("e.stpZ", "5"), ("f.stpZ", "6")];
    assert_eq!(all(&[dir.path().to_owned()]), pairs(&expected));
    assert_eq!(count(&[dir.path().to_owned()]), (5, true));
    assert_eq!(count(&[dir.path().join("a.stp"), "-".into()]), (1, false));
}

#[test]
fn members_of_every_archive_get_the_same_ids() {
    let dir = tempfile::tempdir().unwrap();
    let tar = tar_of(&MEMBERS);
    let files = [
        ("m.tar", tar.clone()),
        ("m.tgz", gzip(&tar)),
        ("m.tar.xz", xz(&tar)),
        ("m.tar.zst", zstd::encode_all(&tar[..], 1).unwrap()),
        ("m.zip", zip_of(&MEMBERS)),
    ];
    for (name, bytes) in files {
        let path = dir.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let expected = [("a/x.step", "one"), ("../y.STP", "two"), ("z.p21", "three")];
        let expected: Vec<_> = expected.iter().map(|(id, text)| (format!("{name}!{id}"), (*text).to_owned())).collect();
        assert_eq!(all(&[path]), expected);
    }
}

#[test]
fn a_seven_zip_archive_is_read() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("in")).unwrap();
    std::fs::write(dir.path().join("in/x.step"), "one").unwrap();
    std::fs::write(dir.path().join("in/y.step"), "y".repeat(101)).unwrap();
    std::fs::write(dir.path().join("in/z.step"), "three").unwrap();
    let path = dir.path().join("m.7z");
    sevenz_rust2::compress_to_path(dir.path().join("in"), &path).unwrap();
    let mut found = all(&[path]);
    found.sort();
    let too_large = "!larger than 100 bytes (setting limits.bytes)";
    assert_eq!(found, pairs(&[("m.7z!x.step", "one"), ("m.7z!y.step", too_large), ("m.7z!z.step", "three")]));
}

#[test]
fn a_broken_member_loses_only_itself() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("m.zip");
    let mut bytes = zip_of(&[("a.step", &"a".repeat(50)), ("b.step", "b")]);
    // Inside the compressed data of the first member: its local header has 30 + 6 bytes.
    bytes[36] ^= 0xff;
    std::fs::write(&path, bytes).unwrap();
    let found = all(&[path]);
    assert!(found[0].1.starts_with('!'), "{found:?}");
    assert_eq!(found[1], ("m.zip!b.step".into(), "b".into()));
}

#[test]
fn a_cut_archive_keeps_what_came_before_and_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("m.tar");
    let tar = tar_of(&[("a.step", "a"), ("b.step", &"b".repeat(90))]);
    std::fs::write(&path, &tar[..1024 + 512 + 10]).unwrap();
    let found = all(&[path]);
    assert_eq!(found[0], ("m.tar!a.step".into(), "a".into()));
    assert!(found.len() >= 2 && found[1..].iter().all(|(_, text)| text.starts_with('!')), "{found:?}");
}

#[test]
fn the_caller_may_end_a_visit_and_missing_inputs_are_errors() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("m.tar");
    std::fs::write(&path, tar_of(&MEMBERS)).unwrap();
    let mut seen = 0;
    let mut each = |_: Member| {
        seen += 1;
        ControlFlow::Break(())
    };
    visit(&[path.clone(), path], &LIMITS, &no_wait, &mut each).unwrap();
    assert_eq!(seen, 1);
    assert!(visit(&[dir.path().join("none")], &LIMITS, &no_wait, &mut |_| ControlFlow::Continue(Vec::new())).is_err());
}

#[test]
fn a_bomb_is_stopped() {
    let zeros = std::io::repeat(0).take(3 << 30);
    let mut budget = Budget::new(zeros, 1000, 100);
    let error = std::io::copy(&mut budget, &mut std::io::sink()).unwrap_err();
    assert!(error.to_string().contains("limits.expansion"));
}

#[test]
fn room_is_asked_before_a_member_is_read_and_as_it_grows() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    std::fs::write(at("a.stp"), vec![b'a'; 60]).unwrap();
    std::fs::write(at("b.stp.gz"), gzip(&[b'b'; 90])).unwrap();
    let size = at("b.stp.gz").metadata().unwrap().len();
    let (asked, given) = (std::cell::RefCell::new(Vec::new()), std::cell::Cell::new(0));
    let room = |bytes| {
        asked.borrow_mut().push((given.get(), bytes));
        ControlFlow::Continue(())
    };
    let mut each = |_| {
        given.set(given.get() + 1);
        ControlFlow::Continue(Vec::new())
    };
    visit(&[dir.path().to_owned()], &LIMITS, &room, &mut each).unwrap();
    let growing: Vec<_> = [1, 2, 4, 8].iter().map(|n| (1, (n * (size + 1)).min(101))).collect();
    let grown = growing.iter().position(|(_, bytes)| *bytes > 90).unwrap();
    assert_eq!(*asked.borrow(), [&[(0, 61)], &growing[..=grown]].concat());
}

#[test]
fn a_visit_that_gets_no_room_ends() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["a.stp", "b.stp"] {
        std::fs::write(dir.path().join(name), "x").unwrap();
    }
    let mut given = 0;
    let mut each = |_| {
        given += 1;
        ControlFlow::Continue(Vec::new())
    };
    visit(&[dir.path().to_owned()], &LIMITS, &|_| ControlFlow::Break(()), &mut each).unwrap();
    assert_eq!(given, 0);
}

#[test]
fn a_file_that_changes_while_it_is_read_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(dir.path().join(name), bytes).unwrap();
    write("a.stp", b"first");
    write("b.zip", &zip_of(&[("x.stp", "member")]));
    // The room for a member is asked between the opening of its file and the reading.
    let asked = std::cell::Cell::new(0);
    let room = |_| {
        asked.set(asked.get() + 1);
        let mut file = std::fs::OpenOptions::new().append(true).open(dir.path().join("a.stp")).unwrap();
        file.write_all(b", then more").unwrap();
        let time = std::time::SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(asked.get());
        std::fs::File::open(dir.path().join("b.zip")).unwrap().set_modified(time).unwrap();
        ControlFlow::Continue(())
    };
    let mut found = Vec::new();
    let mut each = |member: Member| {
        found.push((member.id, member.bytes.err()));
        ControlFlow::Continue(Vec::new())
    };
    visit(&[dir.path().to_owned()], &LIMITS, &room, &mut each).unwrap();
    let changed = Some(CHANGED.to_owned());
    let expected = [("a.stp", changed.clone()), ("b.zip!x.stp", None), ("b.zip", changed)];
    assert_eq!(found, expected.map(|(id, why)| (id.to_owned(), why)));
}
