//! A bitmap font of 5 by 7 points with the characters that the names of axes need.

use tiny_skia::{Color, Paint, Pixmap, Rect, Transform};

/// Width of a character with the space after it, in points of the font.
const ADVANCE: usize = 6;
/// Height of a character, in points of the font.
const HEIGHT: usize = 7;

/// Writes `text` with its top at `y` and its middle at `x`; a point is `size` pixels wide.
/// Characters that the font has not are left blank.
pub fn write(picture: &mut Pixmap, text: &str, [x, y]: [f32; 2], size: usize) {
    let left = x - 0.5 * width(text, size) as f32;
    let (left, top) = (left.round(), y.round());
    let mut paint = Paint::default();
    paint.set_color(Color::from_rgba8(40, 40, 40, 255));
    let size = size as f32;
    for (number, character) in text.chars().enumerate() {
        for (row, bits) in glyph(character).iter().enumerate() {
            for column in (0..5).filter(|column| bits >> (4 - column) & 1 == 1) {
                let point = [left + (number * ADVANCE + column) as f32 * size, top + row as f32 * size];
                if let Some(rect) = Rect::from_xywh(point[0], point[1], size, size) {
                    picture.fill_rect(rect, &paint, Transform::identity(), None);
                }
            }
        }
    }
}

/// Width of a text, pixels.
fn width(text: &str, size: usize) -> usize {
    (text.chars().count() * ADVANCE).saturating_sub(1) * size
}

/// Height of a line of text, pixels.
pub fn height(size: usize) -> usize {
    HEIGHT * size
}

fn glyph(character: char) -> [u8; HEIGHT] {
    match character {
        '0' => [0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e],
        '1' => [0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e],
        '2' => [0x0e, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1f],
        '3' => [0x1f, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0e],
        '4' => [0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02],
        '5' => [0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e],
        '6' => [0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e],
        '7' => [0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08],
        '8' => [0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e],
        '9' => [0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c],
        'e' => [0, 0, 0x0e, 0x11, 0x1f, 0x10, 0x0e],
        _ => [0; HEIGHT],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_of_the_labels_is_in_the_font() {
        assert!("e0123456789".chars().all(|c| glyph(c) != [0; HEIGHT]));
    }

    #[test]
    fn a_one_is_drawn_where_it_is_asked_for() {
        let mut picture = Pixmap::new(9, 9).unwrap();
        write(&mut picture, "1", [3.5, 1.0], 1);
        let row = |y: u32| {
            (0..9).map(|x| if picture.pixel(x, y).unwrap().alpha() > 0 { '#' } else { '.' }).collect::<String>()
        };
        assert_eq!(
            (0..9).map(row).collect::<Vec<_>>(),
            [
                ".........",
                "...#.....",
                "..##.....",
                "...#.....",
                "...#.....",
                "...#.....",
                "...#.....",
                "..###....",
                ".........",
            ]
        );
        assert_eq!(width("12", 2), 22);
    }
}
