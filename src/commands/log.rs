//! `--log FILE`: the events of a run as JSON lines.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use symalign::error::{Result, RunError};

/// Sends all events to the end of the file at `path`.
///
/// Errors: the file cannot be opened. A file that cannot be written later does not disturb the run.
pub fn to_file(path: &Path) -> Result<()> {
    let file = OpenOptions::new().append(true).create(true).open(path).map_err(|e| RunError::file(path, e))?;
    let lines = Mutex::new(Lines { path: path.to_owned(), file: Some(file) });
    let format = tracing_subscriber::fmt().json().flatten_event(true).with_current_span(false).with_span_list(false);
    let subscriber = format.with_target(false).log_internal_errors(false).with_writer(lines).finish();
    tracing::subscriber::set_global_default(subscriber).map_err(|e| RunError::Usage(e.to_string()))
}

/// Writes lines until one cannot be written, says so, and takes no more: half a log is better than half a run.
struct Lines {
    path: PathBuf,
    file: Option<File>,
}

impl Write for Lines {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        if let Some(Err(error)) = self.file.as_mut().map(|file| file.write_all(line)) {
            self.file = None;
            let _ = writeln!(io::stderr(), "{}: {error}; the log ends here, the run goes on", self.path.display());
        }
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
