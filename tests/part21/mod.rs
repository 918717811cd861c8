//! Part 21 text, changed as broken writers and hostile hands change it; shared by the property tests and the fuzzer.
#![allow(dead_code)] // each program uses its part

pub mod reading;

use std::ops::Range;

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_pcg::Pcg64;

/// Numbers that readers trip over.
const NUMBERS: [&str; 24] = [
    "0.",
    "-0.",
    "1.",
    "-1.",
    "0.5",
    "1.E-9",
    "1.E-30",
    "1.E-300",
    "1.E9",
    "1.E30",
    "1.E300",
    "-1.E300",
    "1.E999",
    "NAN",
    "INF",
    "3.141592653589793",
    "90.",
    "360.",
    "2",
    "-2",
    "26",
    "4294967296",
    "9007199254740993.",
    "$",
];

/// Instances made of others: `@` stands for the one that is to be wrapped.
const WRAPPERS: [&str; 14] = [
    "TRIMMED_CURVE('',@,(PARAMETER_VALUE(0.1)),(PARAMETER_VALUE(0.9)),.T.,.PARAMETER.)",
    "TRIMMED_CURVE('',@,(PARAMETER_VALUE(2.)),(PARAMETER_VALUE(-1.)),.F.,.PARAMETER.)",
    "OFFSET_CURVE_3D('',@,0.3,.F.,#6)",
    "SURFACE_CURVE('',@,(),.PCURVE_S1.)",
    "COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.F.,@)",
    "COMPOSITE_CURVE('',(@,@),.U.)",
    "SURFACE_OF_LINEAR_EXTRUSION('',@,#8)",
    "SURFACE_OF_REVOLUTION('',@,#9)",
    "OFFSET_SURFACE('',@,0.3,.F.)",
    "RECTANGULAR_TRIMMED_SURFACE('',@,0.1,0.9,0.1,0.9,.T.,.T.)",
    "ORIENTED_EDGE('',*,*,@,.F.)",
    "ORIENTED_FACE('',*,@,.F.)",
    "ORIENTED_CLOSED_SHELL('',*,@,.F.)",
    "SUBEDGE('',#1,#2,@)",
];

/// A file in pieces.
#[derive(Clone, Debug, Default)]
pub struct Text {
    /// What comes before the first instance.
    pub head: Vec<u8>,
    /// From `#` to behind the semicolon, without the space between them.
    pub instances: Vec<Vec<u8>>,
    /// What comes after the last instance.
    pub tail: Vec<u8>,
}

/// What a piece of an instance is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Token {
    Reference,
    Number,
    /// A word in capitals.
    Keyword,
    /// A word between dots.
    Flag,
    String,
    /// A parenthesis, a comma, an equals sign.
    Mark,
}

impl Text {
    /// Splits well-formed text; anything else lands in some piece.
    pub fn split(bytes: &[u8]) -> Self {
        let mut text = Self::default();
        let data = bytes.windows(5).position(|w| w == b"DATA;").map_or(0, |at| at + 5);
        let mut at = data;
        loop {
            let start = at + bytes[at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
            let Some(end) = statement_end(bytes, start).filter(|_| bytes.get(start) == Some(&b'#')) else { break };
            text.instances.push(bytes[start..end].to_vec());
            at = end;
        }
        text.head = bytes[..data].to_vec();
        text.tail = bytes[at..].to_vec();
        text
    }

    /// The whole file again, an instance a line.
    pub fn join(&self) -> Vec<u8> {
        let mut bytes = self.head.clone();
        for instance in &self.instances {
            bytes.push(b'\n');
            bytes.extend_from_slice(instance);
        }
        bytes.extend_from_slice(&self.tail);
        bytes
    }

    /// Makes one change that leaves the text of Part 21's form, mostly.
    pub fn change(&mut self, rng: &mut Pcg64) {
        if self.instances.is_empty() {
            return;
        }
        let at = rng.random_range(0..self.instances.len());
        match rng.random_range(0..20) {
            0..=4 => self.change_number(at, rng),
            5..=9 => self.change_reference(at, rng),
            10..=11 => self.wrap(at, rng),
            12 => self.replace_token(at, Token::Flag, rng, |rng| pick(&[".T.", ".F.", ".U.", "$"], rng)),
            13 => self.change_keyword(at, rng),
            14 | 15 => self.drop_or_repeat_parameter(at, rng),
            16 => {
                let other = rng.random_range(0..self.instances.len());
                self.instances.swap(at, other);
            }
            17 => self.swap_numbers_of_instances(at, rng),
            18 => drop(self.instances.remove(at)),
            _ => {
                let copy = self.instances[at].clone();
                self.instances.insert(rng.random_range(0..=self.instances.len()), copy);
            }
        }
    }

    fn change_number(&mut self, at: usize, rng: &mut Pcg64) {
        let value =
            self.token(at, Token::Number, rng).and_then(|r| text_of(&self.instances[at], r).parse::<f64>().ok());
        self.replace_token(at, Token::Number, rng, |rng| match (value, rng.random_range(0..4)) {
            (Some(value), 0) => format!("{:?}", -value),
            (Some(value), 1) => format!("{:?}", value * (1.0 + 10.0_f64.powi(-rng.random_range(0..12)))),
            _ => pick(&NUMBERS, rng),
        });
    }

    /// Mostly to an instance of the type that was meant.
    fn change_reference(&mut self, at: usize, rng: &mut Pcg64) {
        let meant = self.token(at, Token::Reference, rng).map(|r| text_of(&self.instances[at], r));
        let kind =
            meant.and_then(|id| self.instances.iter().find(|i| number_of(i) == id)).map(|i| keyword_of(i).to_owned());
        let same: Vec<String> =
            self.instances.iter().filter(|i| Some(keyword_of(i)) == kind.as_deref()).map(|i| number_of(i)).collect();
        let (own, any) = (number_of(&self.instances[at]), number_of(self.instances.choose(rng).expect("there is one")));
        self.replace_token(at, Token::Reference, rng, |rng| match rng.random_range(0..8) {
            0 => own.clone(),
            1 => pick(&["#0", "#99999", "#18446744073709551615", "$", "*"], rng),
            2 => any.clone(),
            _ => same.choose(rng).cloned().unwrap_or_else(|| any.clone()),
        });
    }

    /// Puts an instance between another one and what it refers to.
    fn wrap(&mut self, at: usize, rng: &mut Pcg64) {
        let Some(range) = self.token(at, Token::Reference, rng) else { return };
        let id = text_of(&self.instances[at], range.clone());
        let made = format!("#{}", 1000 + self.instances.len());
        let wrapper = pick(&WRAPPERS, rng).replace('@', &id);
        self.instances[at].splice(range, made.bytes());
        self.instances.push(format!("{made}={wrapper};").into_bytes());
    }

    fn change_keyword(&mut self, at: usize, rng: &mut Pcg64) {
        let other = keyword_of(self.instances.choose(rng).expect("there is one")).to_owned();
        self.replace_token(at, Token::Keyword, rng, |_| other.clone());
    }

    /// Leaves out a parameter with its comma, or writes it many times.
    fn drop_or_repeat_parameter(&mut self, at: usize, rng: &mut Pcg64) {
        let tokens = tokens(&self.instances[at]);
        let inner = || tokens.iter().filter(|t| !matches!(t.0, Token::Mark | Token::Keyword)).skip(1);
        let Some((_, range)) = inner().collect::<Vec<_>>().choose(rng).cloned().cloned() else { return };
        let instance = &mut self.instances[at];
        let parameter = instance[range.clone()].to_vec();
        if rng.random_bool(0.5) {
            let comma = usize::from(instance.get(range.end) == Some(&b','));
            instance.drain(range.start..range.end + comma);
        } else {
            let mut repeated = Vec::new();
            for _ in 0..rng.random_range(1..=16) {
                repeated.extend_from_slice(&parameter);
                repeated.push(b',');
            }
            instance.splice(range.start..range.start, repeated);
        }
    }

    /// Two instances take each other's numbers, so that all references to them are swapped.
    fn swap_numbers_of_instances(&mut self, at: usize, rng: &mut Pcg64) {
        let other = rng.random_range(0..self.instances.len());
        let [a, b] = [at, other].map(|i| self.instances[i].clone());
        let body = |i: &[u8]| i[number_of(i).len()..].to_vec();
        self.instances[at] = [number_of(&a).into_bytes(), body(&b)].concat();
        self.instances[other] = [number_of(&b).into_bytes(), body(&a)].concat();
    }

    /// The place of some token of a kind; of references not the instance's own number.
    fn token(&self, at: usize, kind: Token, rng: &mut Pcg64) -> Option<Range<usize>> {
        let all = tokens(&self.instances[at]);
        let found: Vec<_> = all.into_iter().filter(|t| t.0 == kind && t.1.start > 0).collect();
        found.choose(rng).map(|t| t.1.clone())
    }

    fn replace_token(&mut self, at: usize, kind: Token, rng: &mut Pcg64, with: impl Fn(&mut Pcg64) -> String) {
        if let Some(range) = self.token(at, kind, rng) {
            self.instances[at].splice(range, with(rng).into_bytes());
        }
    }
}

fn pick(from: &[&str], rng: &mut Pcg64) -> String {
    from.choose(rng).map_or_else(String::new, |word| (*word).to_owned())
}

/// Behind the semicolon that ends the statement at `at`.
fn statement_end(bytes: &[u8], at: usize) -> Option<usize> {
    let mut quoted = false;
    bytes.iter().enumerate().skip(at).find_map(|(i, b)| {
        quoted ^= *b == b'\'';
        (*b == b';' && !quoted).then_some(i + 1)
    })
}

/// The number of an instance with its `#`.
pub fn number_of(instance: &[u8]) -> String {
    let length = 1 + instance.iter().skip(1).take_while(|b| b.is_ascii_digit()).count();
    text_of(instance, 0..length.min(instance.len()))
}

fn keyword_of(instance: &[u8]) -> &str {
    let word = tokens(instance).into_iter().find(|t| t.0 == Token::Keyword).map_or(0..0, |t| t.1);
    std::str::from_utf8(&instance[word]).unwrap_or_default()
}

fn text_of(bytes: &[u8], range: Range<usize>) -> String {
    String::from_utf8_lossy(&bytes[range]).into_owned()
}

/// The tokens of well-formed text with their places; what is none is passed over.
pub fn tokens(bytes: &[u8]) -> Vec<(Token, Range<usize>)> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(&b) = bytes.get(at) {
        let length = |of: &dyn Fn(u8) -> bool| 1 + bytes[at + 1..].iter().take_while(|b| of(**b)).count();
        let to_next = |end: u8| bytes[at + 1..].iter().position(|b| *b == end).map_or(bytes.len() - at, |n| n + 2);
        let (kind, length) = match b {
            b'#' => (Some(Token::Reference), length(&|b| b.is_ascii_digit())),
            b'\'' => (Some(Token::String), to_next(b'\'')),
            b'.' if bytes.get(at + 1).is_some_and(u8::is_ascii_alphabetic) => (Some(Token::Flag), to_next(b'.')),
            b'0'..=b'9' | b'-' | b'+' | b'.' => {
                (Some(Token::Number), length(&|b| b.is_ascii_digit() || matches!(b, b'.' | b'E' | b'+' | b'-')))
            }
            b'A'..=b'Z' => (Some(Token::Keyword), length(&|b| b.is_ascii_alphanumeric() || b == b'_')),
            b'(' | b')' | b',' | b'=' => (Some(Token::Mark), 1),
            _ => (None, 1),
        };
        found.extend(kind.map(|kind| (kind, at..at + length)));
        at += length;
    }
    found
}
