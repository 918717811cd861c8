//! The hits of a query as a page with pictures.

use super::picture::{data_uri, grey_png};
use super::{Hit, in_words};
use crate::error::{Result, RunError};
use crate::store::{Store, THUMBNAIL};
use askama::Template;
use std::path::Path;

/// What was asked for.
pub struct Asked<'a> {
    /// The model, as the user named it.
    pub model: &'a str,
    /// Its thumbnail as in a store; `None`: no picture.
    pub thumbnail: Option<&'a [u8]>,
    /// The method, "symmetry" or "cpca:phase".
    pub method: &'a str,
}

#[derive(Template)]
#[template(path = "search/page.html")]
struct Page<'a> {
    model: &'a str,
    method: &'a str,
    store: String,
    models: usize,
    picture: Option<String>,
    hits: Vec<Row<'a>>,
}

struct Row<'a> {
    id: &'a str,
    picture: String,
    distance: String,
    views: [String; 3],
    symmetry: String,
}

/// Writes a self-contained page with the pictures of `hits`, their distances and what symmetry was found.
///
/// # Errors
/// A damaged store; a file that cannot be written.
pub fn write_page(path: &Path, store: &Store, asked: &Asked, hits: &[Hit]) -> Result<()> {
    let page = Page {
        model: asked.model,
        method: asked.method,
        store: store.path().display().to_string(),
        models: store.len(),
        picture: asked.thumbnail.map(picture),
        hits: hits.iter().map(|hit| row(store, hit)).collect::<Result<_>>()?,
    };
    let html = page.render().map_err(|error| RunError::Usage(format!("page: {error}")))?;
    std::fs::write(path, html).map_err(|source| RunError::file(path, source))
}

fn row<'a>(store: &'a Store, hit: &Hit) -> Result<Row<'a>> {
    Ok(Row {
        id: store.id(hit.row),
        picture: picture(store.thumbnail(hit.row)?),
        distance: format!("{:.4}", hit.distance),
        views: hit.views.map(|view| format!("{view:.4}")),
        symmetry: in_words(&store.summary(hit.row)?),
    })
}

fn picture(grey: &[u8]) -> String {
    data_uri(&grey_png(grey, THUMBNAIL))
}
