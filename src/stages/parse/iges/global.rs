//! The global section: delimiters, unit, resolution, version.

use super::values::{Delimiters, Value, values};

/// What the global section says.
#[derive(Clone, Debug)]
pub(super) struct Global {
    pub delimiters: Delimiters,
    /// Millimetres in a unit of the file, model space scale included.
    pub unit_mm: f64,
    /// The smallest distance that the sender tells apart, mm; 0 where it does not say.
    pub resolution: f64,
    /// Such as `IGES 5.3`.
    pub version: String,
    /// Why the unit is a guess.
    pub warning: Option<String>,
}

/// Positions of parameters, from 0.
const SCALE: usize = 12;
const UNIT_FLAG: usize = 13;
const UNIT_NAME: usize = 14;
const RESOLUTION: usize = 18;
const VERSION: usize = 22;

/// Reads the section from its lines.
pub(super) fn global(lines: &[&[u8]]) -> Global {
    let text = lines.concat();
    let delimiters = delimiters(&text);
    let mut all = values(&text, delimiters);
    // Where the delimiters are written they may look like the ends of parameters: 1H,,1H;,
    let real = |all: &[Value], at: usize| match all.get(at) {
        Some(Value::Real(value)) => Some(*value),
        _ => None,
    };
    all.resize(VERSION.max(all.len()) + 1, Value::Nothing);
    let name = match &all[UNIT_NAME] {
        Value::Text(name) => name.trim_ascii().to_ascii_uppercase(),
        _ => Vec::new(),
    };
    let flag = real(&all, UNIT_FLAG).filter(|flag| (1.0..=11.0).contains(flag)).map(|flag| flag as u32);
    let (unit, warning) = unit(flag, &name);
    // Sizes in the file are real ones times the scale.
    let scale = real(&all, SCALE).filter(|s| *s > 0.0).unwrap_or(1.0);
    let unit_mm = unit / scale;
    let resolution = real(&all, RESOLUTION).filter(|r| *r > 0.0).unwrap_or(0.0) * unit_mm;
    let version = version(real(&all, VERSION));
    Global { delimiters, unit_mm, resolution, version, warning }
}

/// The first two parameters are the delimiters themselves as strings of one character, or left out.
fn delimiters(text: &[u8]) -> Delimiters {
    let mut found = Delimiters::default();
    let text = text.trim_ascii_start();
    let rest = match text {
        [b'1', b'H' | b'h', delimiter, rest @ ..] => {
            found.parameter = *delimiter;
            rest.strip_prefix(&[*delimiter]).unwrap_or(rest)
        }
        [delimiter, rest @ ..] if *delimiter == found.parameter => rest,
        _ => text,
    };
    if let [b'1', b'H' | b'h', delimiter, ..] = rest.trim_ascii_start() {
        found.record = *delimiter;
    }
    found
}

/// Millimetres in a unit: by its flag, where that is 3 or missing by its name, else inches.
fn unit(flag: Option<u32>, name: &[u8]) -> (f64, Option<String>) {
    let by_flag = match flag {
        Some(1) => Some(25.4),
        Some(2) => Some(1.0),
        Some(4) => Some(304.8),
        Some(5) => Some(1_609_344.0),
        Some(6) => Some(1e3),
        Some(7) => Some(1e6),
        Some(8) => Some(0.0254),
        Some(9) => Some(1e-3),
        Some(10) => Some(10.0),
        Some(11) => Some(25.4e-6),
        _ => None,
    };
    let by_name = match name {
        b"IN" | b"INCH" | b"INCHES" => Some(25.4),
        b"MM" => Some(1.0),
        b"FT" => Some(304.8),
        b"MI" => Some(1_609_344.0),
        b"M" => Some(1e3),
        b"KM" => Some(1e6),
        b"MIL" => Some(0.0254),
        b"UM" => Some(1e-3),
        b"CM" => Some(10.0),
        b"UIN" => Some(25.4e-6),
        _ => None,
    };
    match by_flag.or(by_name) {
        Some(unit) => (unit, None),
        None => (25.4, Some("the file names no unit that is known; it is taken as inches".to_owned())),
    }
}

/// The version for its number in the file (IGES 5.3, 2.2.4.3.23).
fn version(number: Option<f64>) -> String {
    match number.map_or(3, |n| n as i64) {
        ..=3 => "IGES 2.0",
        4 | 5 => "IGES 3.0",
        6 | 7 => "IGES 4.0",
        8 => "IGES 5.0",
        9 => "IGES 5.1",
        10 => "IGES 5.2",
        _ => "IGES 5.3",
    }
    .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_comes_by_flag_or_name_with_the_scale() {
        let read = |flag: &str| global(&[format!("1H,,1H;,1Ha,1Hb,1Hc,1Hd,32,38,6,308,15,1Ha,{flag};").as_bytes()]);
        assert_eq!(read("1.,2,2HMM,1,0.01,1Hd,0.001,7.5,1Ha,1Hb,11,0").unit_mm, 1.0);
        assert_eq!(read("1.,2,2HMM,1,0.01,1Hd,0.001,7.5,1Ha,1Hb,11,0").resolution, 0.001);
        assert_eq!(read("1.,2,2HMM,1,0.01,1Hd,0.001,7.5,1Ha,1Hb,11,0").version, "IGES 5.3");
        assert_eq!(read("1.,3,2HCM").unit_mm, 10.0);
        assert_eq!(read("0.5,1,4HINCH").unit_mm, 50.8);
        let unknown = read("1.,3,3HELL");
        assert_eq!((unknown.unit_mm, unknown.warning.is_some()), (25.4, true));
    }

    #[test]
    fn delimiters_are_what_the_file_says() {
        let of = |text: &[u8]| delimiters(text);
        let found = |parameter, record| Delimiters { parameter, record };
        assert_eq!(of(b",,3Habc"), found(b',', b';'));
        assert_eq!(of(b"1H/,1H#,"), found(b'/', b';'));
        assert_eq!(of(b"1H//1H#/"), found(b'/', b'#'));
        assert_eq!(of(b"1H,,1H;,"), found(b',', b';'));
        assert_eq!(of(b""), found(b',', b';'));
    }
}
