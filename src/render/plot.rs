//! The area curve: projected area over the angle of the plane (the paper's figure 4), drawn by kuva.

use std::io;

use kuva::backend::raster::RasterBackend;
use kuva::prelude::{Layout, LinePlot, Plot, render_multiple};

/// Room above the curve, as a share of the largest area.
const HEADROOM: f64 = 1.05;
const CURVE: &str = "#1e5ac8";
const CHOSEN: &str = "#d22828";

/// Draws projected areas (mm^2) over angles (radians), with a mark at the angle that was chosen, as a PNG file.
///
/// # Errors
/// What the drawing library says.
pub fn area_curve(angles: &[f64], areas: &[f64], chosen: f64) -> io::Result<Vec<u8>> {
    let most = HEADROOM * areas.iter().copied().filter(|a| a.is_finite()).fold(0.0, f64::max);
    let most = if most > 0.0 { most } else { 1.0 };
    let last = angles.iter().map(|a| a.to_degrees()).filter(|a| a.is_finite()).fold(1.0, f64::max);
    let points = angles.iter().zip(areas).map(|(angle, area)| (angle.to_degrees(), *area));
    let curve = LinePlot::new().with_data(points).with_color(CURVE).with_stroke_width(2.2);
    let mark = chosen.to_degrees();
    let mark = LinePlot::new().with_data([(mark, 0.0), (mark, most)]).with_color(CHOSEN).with_stroke_width(1.5);
    let plots = vec![Plot::Line(curve), Plot::Line(mark.with_dashed())];
    let layout = Layout::auto_from_plots(&plots).with_width(800.0).with_height(500.0);
    let layout = layout.with_x_label("angle of the plane / degrees").with_y_label("projected area / mm²");
    let layout =
        layout.with_x_axis_min(0.0).with_x_axis_max(last).with_x_tick_step(if last > 60.0 { 30.0 } else { last });
    let layout = layout.with_y_axis_min(0.0).with_y_axis_max(most).with_y_tick_step(nice_step(most / 5.0));
    RasterBackend::new().with_scale(1.5).render_scene(&render_multiple(plots, layout)).map_err(io::Error::other)
}

/// The least of 1, 2, 5 times a power of ten that is not below `step`.
fn nice_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0].map(|m| m * power).into_iter().find(|s| *s >= step).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!([0.3, 7.0, 20.0].map(nice_step), [0.5, 10.0, 20.0]);
    }

    #[test]
    fn a_curve_is_drawn_even_without_points() {
        let curves: [(&[f64], &[f64]); 2] = [(&[], &[]), (&[0.0, 1.0], &[2.0, 3.0])];
        for (angles, areas) in curves {
            assert!(area_curve(angles, areas, 0.0).unwrap().starts_with(b"\x89PNG"));
        }
    }
}
