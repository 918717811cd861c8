//! The area curve: projected area over the angle of the plane (the paper's figure 4).

use tiny_skia::{Color, LineCap, Paint, PathBuilder, Pixmap, Stroke, Transform};

use super::text::{self, Align};

/// Size of the picture, pixels.
const SIZE: [u32; 2] = [960, 600];
/// Left, top, right and bottom margins, pixels.
const MARGINS: [f32; 4] = [120.0, 40.0, 30.0, 80.0];
/// Pixels to a point of the font.
const FONT: usize = 2;

/// Draws projected areas (mm^2) over angles (radians), with a mark at the angle that was chosen.
pub fn area_curve(angles: &[f64], areas: &[f64], chosen: f64) -> Pixmap {
    let mut picture = Pixmap::new(SIZE[0], SIZE[1]).expect("the size is a constant above zero");
    picture.fill(Color::WHITE);
    let degrees: Vec<_> = angles.iter().map(|a| a.to_degrees()).collect();
    let across = Scale::over(&degrees, MARGINS[0], SIZE[0] as f32 - MARGINS[2], 30.0);
    let most = areas.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let up = Scale::over(&[0.0, 1.05 * most], SIZE[1] as f32 - MARGINS[3], MARGINS[1], nice_step(most / 5.0));
    grid(&mut picture, &across, &up);
    let points: Vec<_> = degrees.iter().zip(areas).map(|(x, y)| [across.at(*x), up.at(*y)]).collect();
    line(&mut picture, &points, [30, 90, 200], 3.0);
    let mark = across.at(chosen.to_degrees());
    line(&mut picture, &[[mark, up.pixels[0]], [mark, up.pixels[1]]], [210, 40, 40], 2.0);
    picture
}

/// A linear map from values to pixels, with the distance of its ticks.
struct Scale {
    values: [f64; 2],
    pixels: [f32; 2],
    step: f64,
}

impl Scale {
    fn over(values: &[f64], from: f32, to: f32, step: f64) -> Self {
        let fold = |(low, high): (f64, f64), v: &f64| (low.min(*v), high.max(*v));
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), fold);
        let (low, high) = if high > low { (low, high) } else { (0.0, 1.0) };
        Self { values: [low, high], pixels: [from, to], step }
    }

    fn at(&self, value: f64) -> f32 {
        let share = (value - self.values[0]) / (self.values[1] - self.values[0]);
        self.pixels[0] + share as f32 * (self.pixels[1] - self.pixels[0])
    }

    fn ticks(&self) -> impl Iterator<Item = f64> + '_ {
        let first = (self.values[0] / self.step).ceil();
        (0..50).map(move |k| (first + f64::from(k)) * self.step).take_while(|t| *t <= self.values[1])
    }
}

/// The least of 1, 2, 5 times a power of ten that is not below `step`.
fn nice_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0].map(|m| m * power).into_iter().find(|s| *s >= step).unwrap_or(10.0 * power)
}

fn grid(picture: &mut Pixmap, across: &Scale, up: &Scale) {
    let half_line = text::height(FONT) as f32 * 0.5;
    for tick in across.ticks() {
        let x = across.at(tick);
        line(picture, &[[x, up.pixels[0]], [x, up.pixels[1]]], [225, 225, 225], 1.0);
        text::write(picture, &format!("{tick:.0}"), [x, up.pixels[0] + 12.0], FONT, Align::Middle);
    }
    for tick in up.ticks() {
        let y = up.at(tick);
        line(picture, &[[across.pixels[0], y], [across.pixels[1], y]], [225, 225, 225], 1.0);
        text::write(picture, &number(tick), [across.pixels[0] - 12.0, y - half_line], FONT, Align::Right);
    }
    let frame = [[across.pixels[0], up.pixels[1]], [across.pixels[0], up.pixels[0]], [across.pixels[1], up.pixels[0]]];
    line(picture, &frame, [60, 60, 60], 2.0);
    let below = SIZE[1] as f32 - 30.0;
    let middle = 0.5 * (across.pixels[0] + across.pixels[1]);
    text::write(picture, "angle of the plane / degrees", [middle, below], FONT, Align::Middle);
    text::write(picture, "projected area / mm²", [10.0, 12.0], FONT, Align::Left);
}

/// A tick's number, short: six significant digits, an exponent where that is shorter.
fn number(value: f64) -> String {
    let plain = format!("{}", (value * 1e6).round() / 1e6);
    if value != 0.0 && (value.abs() >= 1e6 || value.abs() < 1e-3) { format!("{value:.1e}") } else { plain }
}

fn line(picture: &mut Pixmap, points: &[[f32; 2]], [r, g, b]: [u8; 3], width: f32) {
    let mut path = PathBuilder::new();
    for (i, [x, y]) in points.iter().enumerate() {
        if i == 0 { path.move_to(*x, *y) } else { path.line_to(*x, *y) }
    }
    let mut paint = Paint::default();
    paint.set_color(Color::from_rgba8(r, g, b, 255));
    let stroke = Stroke { width, line_cap: LineCap::Round, ..Stroke::default() };
    if let Some(path) = path.finish() {
        picture.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(nice_step(0.3), 0.5);
        assert_eq!(nice_step(7.0), 10.0);
        let scale = Scale::over(&[0.0, 4.2], 100.0, 0.0, 2.0);
        assert_eq!(scale.ticks().collect::<Vec<_>>(), [0.0, 2.0, 4.0]);
        assert_eq!((number(1500.0), number(2e7)), ("1500".to_owned(), "2.0e7".to_owned()));
    }

    #[test]
    fn a_curve_is_drawn_even_without_points() {
        assert_eq!(area_curve(&[], &[], 0.0).width(), SIZE[0]);
    }
}
