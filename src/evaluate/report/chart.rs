//! The precision-recall curves, drawn by kuva: as SVG for the page and as a PNG file.

use super::super::Evaluation;
use super::super::formats::table;
use super::super::precision_recall::{INTERPOLATED, PRINCETON};
use super::super::source::is_phase;
use crate::search::Name;
use kuva::backend::raster::RasterBackend;
use kuva::prelude::{Layout, LegendPosition, LinePlot, LineStyle, Plot, SvgBackend, Theme, render_multiple};
use serde::Serialize;

/// Colours of the frames, on light and on dark ground; the first are told apart by people with any colour vision (after
/// Okabe and Ito 2008).
const COLOURS: [[&str; 2]; 10] = [
    ["#0072b2", "#4db2f0"],
    ["#d55e00", "#ff8a3d"],
    ["#009e73", "#2fcf9f"],
    ["#c0569a", "#e596c6"],
    ["#444444", "#d0d0d0"],
    ["#e69f00", "#ffc44d"],
    ["#56b4e9", "#a5dcff"],
    ["#8c564b", "#c79388"],
    ["#7b4bb7", "#b694ea"],
    ["#6f8f00", "#b5d33d"],
];
/// What a page shows before anything is chosen: the method and the frames it is compared with in the field.
const FIRST: [&str; 4] = ["symmetry", "pca", "cpca", "npca"];
/// Long enough to be seen between the round ends of thick lines.
const DASH: &str = "9 7";
/// The colour of the random ranking.
const CHANCE: &str = "#888888";

/// A method as the page shows it: phases are dashed, in the colour of their frame's magnitudes.
pub struct Style<'a> {
    pub name: &'a str,
    /// On light and on dark ground.
    pub colours: [&'static str; 2],
    pub dashed: bool,
    /// Whether the page shows it before anything is chosen.
    pub shown: bool,
}

/// The styles of all methods, in order. Shown at first are those of [`FIRST`] and the results of others; all, where
/// there are none of these.
pub fn styles(evaluation: &Evaluation) -> Vec<Style<'_>> {
    let first = |name: &str| FIRST.contains(&name) || name.parse::<Name>().is_err();
    let some = evaluation.methods.iter().any(|method| first(&method.name));
    let frame =
        |name: &'_ str| if is_phase(name) { name.trim_end_matches(":phase").to_owned() } else { name.to_owned() };
    let mut frames: Vec<String> = Vec::new();
    let style = |name| {
        let place = frames.iter().position(|known| *known == frame(name)).unwrap_or_else(|| {
            frames.push(frame(name));
            frames.len() - 1
        });
        let shown = !some || first(name);
        Style { name, colours: COLOURS[place % COLOURS.len()], dashed: is_phase(name), shown }
    };
    evaluation.methods.iter().map(|method| method.name.as_str()).map(style).collect()
}

/// Curves for the page: the picture, and the numbers for those who point at it.
pub struct Curves {
    pub title: &'static str,
    pub note: &'static str,
    pub svg: String,
    /// `{"recall": [..], "series": [[..], ..]}`, the series of all methods, then chance.
    pub numbers: String,
}

/// Which points of the curves.
#[derive(Clone, Copy)]
enum Points {
    Interpolated,
    Princeton,
}

#[derive(Serialize)]
struct Numbers {
    recall: Vec<f64>,
    series: Vec<Vec<Option<f64>>>,
}

/// The 11-point and the 20-point curves.
pub fn curves(evaluation: &Evaluation) -> Vec<Curves> {
    let curves = |points, title, note| {
        let numbers = numbers(evaluation, points);
        let json = serde_json::to_string(&numbers).expect("finite numbers have a form in JSON");
        Curves { title, note, svg: svg(evaluation, &numbers), numbers: json }
    };
    let interpolated = "highest precision at any recall from there on; mean over queries";
    let princeton =
        "precision between the hits, as psbPlot draws it; mean over the queries that reach down to the recall";
    vec![curves(Points::Interpolated, "11 points", interpolated), curves(Points::Princeton, "20 points", princeton)]
}

fn numbers(evaluation: &Evaluation, points: Points) -> Numbers {
    let mut summaries = table::rows(evaluation);
    summaries.pop(); // the ceiling is 1 everywhere
    let curve = |summary: &super::super::Summary| match points {
        Points::Interpolated => summary.micro_curves.pr11.to_vec(),
        Points::Princeton => summary.micro_curves.pr20.to_vec(),
    };
    let recall = match points {
        Points::Interpolated => (0..INTERPOLATED).map(|i| i as f64 / (INTERPOLATED - 1) as f64).collect(),
        Points::Princeton => (1..=PRINCETON).map(|i| i as f64 / PRINCETON as f64).collect(),
    };
    Numbers { recall, series: summaries.into_iter().map(|(_, summary)| curve(summary)).collect() }
}

/// One line for each series; `colour` and `legend` by its place, of which the last is chance.
fn lines(
    evaluation: &Evaluation,
    numbers: &Numbers,
    colour: impl Fn(usize, &str) -> String,
    legend: bool,
) -> Vec<Plot> {
    let mut styles = styles(evaluation);
    styles.push(Style { name: "chance", colours: [CHANCE; 2], dashed: false, shown: true });
    let line = |(place, (style, series)): (usize, (&Style, &Vec<Option<f64>>))| {
        let points = numbers.recall.iter().zip(series).filter_map(|(&recall, p)| p.map(|p| (recall, p)));
        let dash = match (style.name, style.dashed) {
            ("chance", _) => LineStyle::Dotted,
            (_, true) => LineStyle::Custom(DASH.into()),
            (_, false) => LineStyle::Solid,
        };
        let line = LinePlot::new().with_data(points).with_color(colour(place, style.colours[0])).with_line_style(dash);
        let line = line.with_stroke_width(2.2);
        Plot::Line(if legend { line.with_legend(style.name) } else { line })
    };
    styles.iter().zip(&numbers.series).enumerate().map(line).collect()
}

fn layout(plots: &[Plot]) -> Layout {
    let layout = Layout::auto_from_plots(plots).with_x_label("Recall").with_y_label("Precision");
    let layout = layout.with_x_axis_min(0.0).with_x_axis_max(1.0).with_y_axis_min(0.0).with_y_axis_max(1.0);
    layout.with_x_tick_step(0.2).with_y_tick_step(0.2)
}

/// A picture that takes its colours (`--m0` .. for the series) and its size from the page.
fn svg(evaluation: &Evaluation, numbers: &Numbers) -> String {
    let plots = lines(evaluation, numbers, |place, _| format!("var(--m{place})"), false);
    let (axis, grid) = ("var(--text)".to_owned(), "var(--line)".to_owned());
    let theme = Theme {
        background: "none".into(),
        axis_color: axis.clone(),
        tick_color: axis.clone(),
        text_color: axis,
        grid_color: grid,
        font_family: Some("inherit".into()),
        ..Theme::light()
    };
    let layout = layout(&plots).with_theme(theme).with_width(560.0).with_height(400.0);
    let layout = layout.with_tick_size(14).with_label_size(15);
    fluid(&SvgBackend.render_scene(&render_multiple(plots, layout)))
}

/// The picture with a `viewBox` in place of its fixed size.
fn fluid(svg: &str) -> String {
    let attribute = |name: &str| {
        let start = svg.find(&format!(" {name}=\""))? + name.len() + 3;
        svg[start..].split('"').next()
    };
    let (Some(width), Some(height)) = (attribute("width"), attribute("height")) else { return svg.to_owned() };
    let fixed = format!(" width=\"{width}\" height=\"{height}\"");
    let fluid = format!(" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"precision-recall curves\"");
    svg.replacen(&fixed, &fluid, 1)
}

/// The interpolated curves as a PNG file, with axes and legend.
///
/// # Errors
/// What the drawing library says.
pub fn png(evaluation: &Evaluation) -> Result<Vec<u8>, String> {
    let plots = lines(evaluation, &numbers(evaluation, Points::Interpolated), |_, colour| colour.to_owned(), true);
    let (models, queries) = (evaluation.gallery.len(), evaluation.gallery.queries().len());
    let title = format!("{queries} queries, {models} models");
    let layout = layout(&plots).with_title(title).with_legend_position(LegendPosition::OutsideRightTop);
    RasterBackend::new().with_scale(2.0).render_scene(&render_multiple(plots, layout))
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::toy;
    use super::*;

    #[test]
    fn the_page_s_curves_take_their_colours_from_it() {
        let curves = curves(&toy());
        let svg = &curves[0].svg;
        assert!(svg.starts_with("<svg") && svg.contains("viewBox=\"0 0 "));
        for place in 0..3 {
            assert!(svg.contains(&format!("stroke=\"var(--m{place})\"")), "{place}");
        }
        assert!(svg.contains(">Recall<") && svg.contains(">Precision<"));
        assert!(curves[1].numbers.starts_with("{\"recall\":[0.05,0.1,"));
    }

    #[test]
    fn results_of_others_are_shown_at_first() {
        assert!(styles(&toy()).iter().all(|style| style.shown), "no frame of ours");
    }

    #[test]
    fn the_picture_is_a_png_of_some_size() {
        let file = png(&toy()).unwrap();
        let reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        assert!(reader.info().width > 800 && reader.info().height > 600);
    }
}
