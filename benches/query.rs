//! Times one query and many over rows of magnitudes that lie in a file of f32, mapped: `query ROWS QUERIES K`.
//!
//! Prints the seconds and CPU seconds of one query, of all, and the rows found for the first query, as JSON; the best
//! of three. `benches/query.py` makes the files and compares with faiss.

use std::fs::File;
use std::time::Instant;

use memmap2::Mmap;
use symalign::search::{Kind, Rows};
use symalign::stages::descriptor::MAGNITUDES;
use zerocopy::FromBytes;

/// User and system time of this process, in seconds (in hundredths: Linux counts these).
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<_> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    [11, 12].iter().filter_map(|&i| fields.get(i)?.parse::<f64>().ok()).sum::<f64>() / 100.0
}

fn timed<T>(mut work: impl FnMut() -> T) -> (f64, f64, T) {
    let mut once = || {
        let (start, cpu) = (Instant::now(), cpu_seconds());
        let result = work();
        (start.elapsed().as_secs_f64(), cpu_seconds() - cpu, result)
    };
    let (mut wall, mut cpu, mut result) = once();
    for _ in 0..2 {
        let again = once();
        (wall, cpu, result) = (wall.min(again.0), cpu.min(again.1), again.2);
    }
    (wall, cpu, result)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [rows, queries, k] = std::env::args().skip(1).collect::<Vec<_>>().try_into().map_err(|_| "ROWS QUERIES K")?;
    let k = k.parse()?;
    let (rows, queries) = (File::open(rows)?, File::open(queries)?);
    // SAFETY: the script that made the files waits for this program.
    let (rows, queries) = unsafe { (Mmap::map(&rows)?, Mmap::map(&queries)?) };
    let floats = |map| <[f32]>::ref_from_bytes(map).map_err(|_| "not a file of f32");
    let (rows, queries) = (Rows::new(floats(&rows)?, Kind::Magnitude)?, floats(&queries)?);
    let queries: Vec<_> = queries.chunks_exact(MAGNITUDES).collect();
    let one = timed(|| rows.nearest(queries[0], k));
    let all = timed(|| rows.nearest_to_each(&queries, k));
    let found: Vec<_> = one.2?.iter().map(|hit| (hit.row, hit.distance)).collect();
    let also: Vec<_> = all.2?[0].iter().map(|hit| (hit.row, hit.distance)).collect();
    assert_eq!(found, also);
    let json = serde_json::json!({"one": [one.0, one.1], "all": [all.0, all.1], "found": found});
    println!("{json}");
    Ok(())
}
