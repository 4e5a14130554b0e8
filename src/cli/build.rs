//! A model to its PLC program in files.

use super::args::{Build, Dialect, Format};
use super::files::{self, Pending};
use super::report::{FileReport, Report};
use super::{Outcome, finish, read, say, time, usage};
use crate::base::Diagnostic;
use crate::pipeline::{self, Options};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What was written, for the JSON document.
#[derive(Default, Serialize)]
struct Result {
    written: Vec<Written>,
}

#[derive(Serialize)]
struct Written {
    what: &'static str,
    path: String,
    bytes: usize,
}

/// Runs `chartwright build`.
pub fn run(args: &Build) -> Outcome {
    let out = args.out.clone().unwrap_or_else(|| args.file.with_extension("xml"));
    let created = match check_usage(args, &out) {
        Ok(created) => created,
        Err(message) => return usage("build", &message),
    };
    let dialect = match args.dialect {
        Dialect::Beremiz => pipeline::Dialect::Beremiz,
        Dialect::Codesys => pipeline::Dialect::Codesys,
    };
    let options = Options { dialect, created, prove: !args.no_proof };

    let mut report = Report::default();
    let mut result = Result::default();
    let built = read(&args.file, &mut report, |source| pipeline::build(source, &options)).flatten();
    if let (Some(output), false) = (built, report.has_errors()) {
        let mut texts = vec![("program", out, output.xml)];
        texts.extend(args.names.clone().map(|path| ("names", path, output.names)));
        match write(texts) {
            Ok(written) => result.written = written,
            Err((path, diagnostic)) => report.files.push(FileReport::failed(files::show(&path), diagnostic)),
        }
    }
    let outcome = finish("build", args.output.format, &report, &result);
    if args.output.format == Format::Human {
        let proved = if args.no_proof { "not proved" } else { "proved" };
        for w in result.written.iter().filter(|w| !files::is_standard(Path::new(&w.path))) {
            let proved = if w.what == "program" { format!(", {proved}") } else { String::new() };
            say(&format!("{} written: {} bytes{proved}\n", w.path, w.bytes));
        }
    }
    outcome
}

/// What can be said before anything is read; returns the time of creation.
fn check_usage(args: &Build, out: &Path) -> std::result::Result<String, String> {
    let (file, shown) = (&args.file, files::show(out));
    if !files::is_standard(out) && files::same(file, out) {
        return Err(format!("writing the program to `{shown}` would overwrite the model; give another name with -o"));
    }
    if let Some(names) = &args.names {
        if !files::is_standard(names) && files::same(file, names) {
            return Err("writing the names would overwrite the model".to_owned());
        }
        if files::same(out, names) {
            return Err(format!("the program and the names cannot both be written to `{shown}`"));
        }
    }
    let standard = files::is_standard(out) || args.names.as_deref().is_some_and(files::is_standard);
    if standard && args.output.format == Format::Json {
        return Err("standard output cannot take both the JSON report and a file".to_owned());
    }
    match std::env::var_os("SOURCE_DATE_EPOCH") {
        None => Ok(time::DEFAULT.to_owned()),
        Some(value) => value
            .to_str()
            .and_then(|v| v.parse().ok())
            .and_then(time::date_time)
            .ok_or_else(|| "SOURCE_DATE_EPOCH is no number of seconds since 1970".to_owned()),
    }
}

/// Writes all texts or, as far as that can be known before, none.
fn write(texts: Vec<(&'static str, PathBuf, String)>) -> std::result::Result<Vec<Written>, (PathBuf, Diagnostic)> {
    let mut prepared = Vec::new();
    for (what, path, text) in texts {
        let written = Written { what, path: files::show(&path), bytes: text.len() };
        match Pending::prepare(&path, text) {
            Ok(pending) => prepared.push((written, path, pending)),
            Err(diagnostic) => return Err((path, diagnostic)),
        }
    }
    let mut done = Vec::new();
    for (written, path, pending) in prepared {
        pending.commit().map_err(|diagnostic| (path, diagnostic))?;
        done.push(written);
    }
    Ok(done)
}
