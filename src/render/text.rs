//! A bitmap font of 5 by 7 points with the characters that our figures need.

use tiny_skia::{Color, Paint, Pixmap, Rect, Transform};

/// Width of a character with the space after it, in points of the font.
const ADVANCE: usize = 6;
/// Height of a character, in points of the font.
const HEIGHT: usize = 7;

/// Where a text's given point lies in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Align {
    Left,
    Middle,
    Right,
}

/// Writes `text` with its top at `y` and its left end, middle or right end at `x`; a point is `size` pixels wide.
/// Characters that the font has not are left blank.
pub fn write(picture: &mut Pixmap, text: &str, [x, y]: [f32; 2], size: usize, align: Align) {
    let wide = width(text, size) as f32;
    let left = match align {
        Align::Left => x,
        Align::Middle => x - 0.5 * wide,
        Align::Right => x - wide,
    };
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
pub fn width(text: &str, size: usize) -> usize {
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
        '.' => [0, 0, 0, 0, 0, 0x0c, 0x0c],
        '-' => [0, 0, 0, 0x0e, 0, 0, 0],
        '/' => [0x01, 0x01, 0x02, 0x04, 0x08, 0x10, 0x10],
        '²' => [0x0c, 0x12, 0x04, 0x08, 0x1e, 0, 0],
        '°' => [0x0c, 0x12, 0x12, 0x0c, 0, 0, 0],
        'a' => [0, 0, 0x0e, 0x01, 0x0f, 0x11, 0x0f],
        'd' => [0x01, 0x01, 0x0d, 0x13, 0x11, 0x11, 0x0f],
        'e' => [0, 0, 0x0e, 0x11, 0x1f, 0x10, 0x0e],
        'f' => [0x06, 0x09, 0x08, 0x1c, 0x08, 0x08, 0x08],
        'g' => [0, 0x0f, 0x11, 0x11, 0x0f, 0x01, 0x0e],
        'h' => [0x10, 0x10, 0x16, 0x19, 0x11, 0x11, 0x11],
        'j' => [0x02, 0, 0x06, 0x02, 0x02, 0x12, 0x0c],
        'l' => [0x0c, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e],
        'm' => [0, 0, 0x1a, 0x15, 0x15, 0x11, 0x11],
        'n' => [0, 0, 0x16, 0x19, 0x11, 0x11, 0x11],
        'c' => [0, 0, 0x0e, 0x10, 0x10, 0x11, 0x0e],
        'o' => [0, 0, 0x0e, 0x11, 0x11, 0x11, 0x0e],
        'p' => [0, 0, 0x1e, 0x11, 0x1e, 0x10, 0x10],
        'r' => [0, 0, 0x16, 0x19, 0x10, 0x10, 0x10],
        's' => [0, 0, 0x0f, 0x10, 0x0e, 0x01, 0x1e],
        't' => [0x08, 0x08, 0x1c, 0x08, 0x08, 0x09, 0x06],
        _ => [0; HEIGHT],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_of_the_labels_is_in_the_font() {
        let labels = "angle of the plane / degrees projected area / mm² 0123456789.-e";
        assert!(labels.chars().filter(|c| *c != ' ').all(|c| glyph(c) != [0; HEIGHT]));
    }

    #[test]
    fn a_one_is_drawn_where_it_is_asked_for() {
        let mut picture = Pixmap::new(9, 9).unwrap();
        write(&mut picture, "1", [1.0, 1.0], 1, Align::Left);
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
