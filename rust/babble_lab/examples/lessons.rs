//! Writes the lessons of `lessons/*.toml` as one JSON file, which the engine reads: a parser of TOML would be a
//! tenth of what a browser has to load.
//!
//!     cargo run -p babble_lab --example lessons > rust/babble_lab/lessons/lessons.json

use std::path::Path;
use std::{error, fs};

use serde_json::Value;

fn main() -> Result<(), Box<dyn error::Error>> {
    println!("{}", serde_json::to_string_pretty(&lessons()?)?);
    Ok(())
}

/// The files in the order of their names.
fn lessons() -> Result<Vec<Value>, Box<dyn error::Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("lessons");
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder)? {
        paths.push(entry?.path());
    }
    paths.retain(|path| {
        path.extension()
            .is_some_and(|extension| extension == "toml")
    });
    paths.sort();
    let read = |path| Ok(toml::from_str(&fs::read_to_string(path)?)?);
    paths.into_iter().map(read).collect()
}
