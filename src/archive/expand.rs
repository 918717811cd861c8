//! Decompression within limits.

use std::io::{self, BufRead, BufReader, Cursor, Read};

use super::kind::Packing;
use crate::memory::empty;

/// What an archive that unpacks to too much fails with.
pub const TOO_LARGE: &str = "it unpacks to more than the setting limits.expansion allows";

/// Archives may always unpack to this much, bytes.
const FREE: u64 = 1 << 30;
/// Bytes that are reserved before they have come at most: an archive may announce any number.
const MOST_RESERVED: usize = 64 << 20;

/// The decompressed bytes of `reader`.
pub fn unpacked<'a>(packing: Packing, reader: impl Read + 'a) -> io::Result<Box<dyn Read + 'a>> {
    Ok(match packing {
        Packing::Plain => Box::new(reader),
        Packing::Gzip => gzip_or_zip(reader)?,
        Packing::Xz => Box::new(liblzma::read::XzDecoder::new_multi_decoder(reader)),
        Packing::Zstd => Box::new(zstd::Decoder::new(reader)?),
    })
}

/// `.stpZ` files hold gzip data from some systems, a zip archive with one member from others.
fn gzip_or_zip<'a>(reader: impl Read + 'a) -> io::Result<Box<dyn Read + 'a>> {
    let mut reader = BufReader::new(reader);
    if reader.fill_buf()?.starts_with(b"PK\x03\x04") {
        return Ok(Box::new(OnlyMember { reader, unpacked: None }));
    }
    Ok(Box::new(flate2::bufread::MultiGzDecoder::new(reader)))
}

/// The first member of a zip stream, unpacked when it is first read.
struct OnlyMember<R> {
    reader: R,
    unpacked: Option<Cursor<Vec<u8>>>,
}

/// A member of a `.stpZ` zip is held in memory, so it is limited here, too.
const ONLY_MEMBER: u64 = 2 << 30;

impl<R: Read> Read for OnlyMember<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.unpacked.is_none() {
            let mut bytes = Vec::new();
            if let Some(member) = zip::read::read_zipfile_from_stream(&mut self.reader).map_err(io::Error::other)? {
                member.take(ONLY_MEMBER).read_to_end(&mut bytes)?;
            }
            self.unpacked = Some(Cursor::new(bytes));
        }
        self.unpacked.as_mut().map_or(Ok(0), |cursor| cursor.read(buffer))
    }
}

/// A stream that may be compressed, decompressed: told by its first bytes.
pub fn sniffed<'a>(reader: impl Read + 'a) -> Box<dyn Read + 'a> {
    let mut reader = BufReader::new(reader);
    let packing = match reader.fill_buf() {
        Ok([0x1f, 0x8b, ..]) => Packing::Gzip,
        Ok([0xfd, b'7', b'z', b'X', b'Z', ..]) => Packing::Xz,
        Ok([0x28, 0xb5, 0x2f, 0xfd, ..]) => Packing::Zstd,
        _ => Packing::Plain,
    };
    unpacked(packing, reader).unwrap_or_else(|error| Box::new(Failing(Some(error))))
}

/// Gives its error once, then ends.
struct Failing(Option<io::Error>);

impl Read for Failing {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        self.0.take().map_or(Ok(0), Err)
    }
}

/// All bytes of `reader`, if they are no more than `limit`, in the memory of `bytes`. About `expected` are thought to
/// come; `room` is asked before these are read, and again each time that twice as many come.
pub fn read_limited(
    mut reader: impl Read,
    mut bytes: Vec<u8>,
    expected: u64,
    limit: u64,
    mut room: impl FnMut(u64) -> Result<(), String>,
) -> Result<Vec<u8>, String> {
    let most = limit.saturating_add(1);
    bytes.clear();
    let (before, mut granted) = (bytes.capacity(), 0);
    while bytes.len() as u64 == granted && granted < most {
        // One more than is expected, to see that it ends there.
        granted = expected.saturating_add(1).max(2 * granted).min(most);
        room(granted)?;
        let more = (granted as usize - bytes.len()).min(MOST_RESERVED);
        if bytes.is_empty() {
            empty(&mut bytes, more)
        } else {
            bytes.reserve_exact(more)
        }
        let part = reader.by_ref().take(granted - bytes.len() as u64).read_to_end(&mut bytes);
        part.map_err(|e| format!("cannot be read: {e}"))?;
    }
    if bytes.len() as u64 > limit {
        return Err(format!("larger than {limit} bytes (setting limits.bytes)"));
    }
    // An archive may have announced more than came.
    if bytes.capacity() > before.max(2 * bytes.len()) {
        bytes.shrink_to_fit();
    }
    Ok(bytes)
}

/// Bytes that an archive of `size` bytes may unpack to.
pub fn allowance(size: u64, expansion: u64) -> u64 {
    size.saturating_mul(expansion).max(FREE)
}

/// Passes bytes on until they are more than the archive may unpack to.
pub struct Budget<R> {
    reader: R,
    left: u64,
}

impl<R> Budget<R> {
    /// For an archive of `size` bytes.
    pub fn new(reader: R, size: u64, expansion: u64) -> Self {
        Self { reader, left: allowance(size, expansion) }
    }
}

impl<R: Read> Read for Budget<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(io::Error::other(TOO_LARGE));
        }
        let n = self.reader.read(buffer)?;
        self.left = self.left.saturating_sub(n as u64);
        Ok(n)
    }
}

/// Passes bytes on; it is an error if they end before `left` of them came, as in an archive that was cut off.
pub struct Whole<R> {
    reader: R,
    left: u64,
}

impl<R> Whole<R> {
    /// For a member of `size` bytes.
    pub fn new(reader: R, size: u64) -> Self {
        Self { reader, left: size }
    }
}

impl<R: Read> Read for Whole<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.reader.read(buffer)?;
        if n == 0 && self.left > 0 && !buffer.is_empty() {
            return Err(io::Error::new(io::ErrorKind::UnexpectedEof, format!("{} bytes are missing", self.left)));
        }
        self.left = self.left.saturating_sub(n as u64);
        Ok(n)
    }
}
