//! Grey pictures as PNG and as data URIs, so that a page can hold them itself.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

/// `grey`, `side` by `side` levels row by row, as a PNG file.
///
/// Rows that are missing stay black.
pub fn grey_png(grey: &[u8], side: usize) -> Vec<u8> {
    let mut levels = grey.to_vec();
    levels.resize(side * side, 0);
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, side as u32, side as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::High);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&levels));
    written.expect("a vector takes all bytes, and there are as many as the header says");
    file
}

/// A PNG file as a `data:` URI.
pub fn data_uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_comes_back() {
        let file = grey_png(&[0, 255, 7], 2);
        let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        let mut levels = vec![0; 4];
        reader.next_frame(&mut levels).unwrap();
        assert_eq!(levels, [0, 255, 7, 0]);
        // the first six bytes of every PNG are these eight characters
        assert!(data_uri(&file).starts_with("data:image/png;base64,iVBORw0K"));
    }
}
