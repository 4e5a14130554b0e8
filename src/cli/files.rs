//! Paths to text, and text to files that are whole or not there.
//!
//! A run that is ended from outside while it writes may leave a temporary file; the next one that writes into
//! that directory removes it.
//!
//! What goes wrong becomes a diagnostic with [`Code::Unreadable`].

use crate::base::{Code, Diagnostic, limits};
use crate::parse;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The path that means standard output.
pub const STANDARD: &str = "-";

/// How long nobody has to have written a temporary file for it to be a left one. A run holds its own for no
/// longer than it takes to write its results.
const LEFT: Duration = Duration::from_secs(60 * 60);

/// How a path is shown.
pub fn show(path: &Path) -> String {
    annotate_snippets::normalize_untrusted_str(&path.to_string_lossy())
}

/// The text of a model.
pub fn read(path: &Path) -> Result<String, Diagnostic> {
    read_up_to(path, limits::SOURCE_BYTES)
}

/// The text of a PLC project.
pub fn read_program(path: &Path) -> Result<String, Diagnostic> {
    read_up_to(path, limits::PROGRAM_BYTES)
}

/// The text of a file. No more of it is read than is needed to see that it is too large.
fn read_up_to(path: &Path, limit: usize) -> Result<String, Diagnostic> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(limit as u64 + 1).read_to_end(&mut bytes))
        .map_err(|error| failed("read", path, &error))?;
    parse::decode(bytes, limit)
}

/// Whether both paths lead to one file, existing or not.
pub fn same(a: &Path, b: &Path) -> bool {
    place(a) == place(b)
}

/// The path without links and dots as far as it exists.
fn place(path: &Path) -> PathBuf {
    if let Ok(place) = fs::canonicalize(path) {
        return place;
    }
    let parent = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    match (fs::canonicalize(parent), path.file_name()) {
        (Ok(parent), Some(name)) => parent.join(name),
        _ => path.to_owned(),
    }
}

/// Whether the path means standard output.
pub fn is_standard(path: &Path) -> bool {
    path == Path::new(STANDARD)
}

/// A result that is ready to appear under its name. Dropped before [`Pending::commit`], it leaves
/// nothing behind.
#[derive(Debug)]
pub struct Pending {
    target: PathBuf,
    form: Form,
}

#[derive(Debug)]
enum Form {
    /// A complete file under a temporary name beside the target; gone once it is renamed.
    Renamed(Option<PathBuf>),
    /// The target is no regular file (standard output, a device, a pipe) and cannot be replaced.
    Direct(Vec<u8>),
}

impl Pending {
    /// Does all that can fail for lack of space or rights, except for the last step.
    pub fn prepare(target: &Path, text: impl Into<Vec<u8>>) -> Result<Pending, Diagnostic> {
        let text = text.into();
        let fail = |error: io::Error| failed("written", target, &error);
        let direct = |text| Ok(Pending { target: target.to_owned(), form: Form::Direct(text) });
        if is_standard(target) {
            return direct(text);
        }
        let existing = match fs::metadata(target) {
            Ok(metadata) => Some(metadata),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(fail(error)),
        };
        if let Some(metadata) = &existing {
            if metadata.is_dir() {
                return Err(fail(io::ErrorKind::IsADirectory.into()));
            }
            if !metadata.is_file() {
                return direct(text);
            }
            // Renaming over it would succeed all the same.
            if metadata.permissions().readonly() {
                return Err(fail(io::ErrorKind::PermissionDenied.into()));
            }
        }
        // Through links, so that a link stays one.
        let target = place(target);
        clear_beside(&target);
        let (temporary, mut file) = create_beside(&target).map_err(fail)?;
        let pending = Pending { target, form: Form::Renamed(Some(temporary)) };
        file.write_all(&text)
            .and_then(|()| existing.map_or(Ok(()), |metadata| file.set_permissions(metadata.permissions())))
            .and_then(|()| file.sync_all())
            .map_err(fail)?;
        Ok(pending)
    }

    /// Makes the text appear under its name.
    pub fn commit(mut self) -> Result<(), Diagnostic> {
        let done = match &mut self.form {
            Form::Renamed(temporary) => {
                let from = temporary.take().expect("a pending text is committed once");
                fs::rename(&from, &self.target).inspect_err(|_| discard(&from))
            }
            Form::Direct(text) if is_standard(&self.target) => print(text),
            Form::Direct(text) => OpenOptions::new().write(true).open(&self.target).and_then(|mut f| f.write_all(text)),
        };
        done.map_err(|error| failed("written", &self.target, &error))
    }
}

impl Drop for Pending {
    fn drop(&mut self) {
        if let Form::Renamed(Some(temporary)) = &self.form {
            discard(temporary);
        }
    }
}

/// Removes a temporary file; that it cannot be removed is not worth a word beside what went wrong.
fn discard(temporary: &Path) {
    let _ = fs::remove_file(temporary);
}

/// What names of temporary files begin with; then come the number of the process and one of the file.
const TEMPORARY: &str = ".chartwright-";

/// Whether this is the name of a temporary file.
fn is_temporary(name: &str) -> bool {
    let number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let numbers = name.strip_prefix(TEMPORARY).and_then(|rest| rest.strip_suffix(".tmp"));
    numbers.and_then(|n| n.split_once('-')).is_some_and(|(process, file)| number(process) && number(file))
}

/// Removes what runs have left in the directory of `target` that were ended while they wrote. What cannot be
/// read or removed stays: it is not what this run is for.
fn clear_beside(target: &Path) {
    let directory = target.with_file_name(".");
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let left = || -> io::Result<bool> {
            let metadata = entry.metadata()?;
            // A time in the future is no age.
            let age = metadata.modified()?.elapsed().unwrap_or_default();
            Ok(metadata.is_file() && age > LEFT)
        };
        if entry.file_name().to_str().is_some_and(is_temporary) && left().unwrap_or(false) {
            discard(&entry.path());
        }
    }
}

/// A new empty file in the directory of `target`: only there a rename is atomic.
fn create_beside(target: &Path) -> io::Result<(PathBuf, File)> {
    let mut attempt = 0;
    loop {
        let name = format!("{TEMPORARY}{}-{attempt}.tmp", std::process::id());
        let path = target.with_file_name(name);
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempt < 100 => attempt += 1,
            opened => return opened.map(|file| (path, file)),
        }
    }
}

/// Writes to standard output. Unlike `print!`, it survives a reader that has gone.
pub fn print(text: &[u8]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text)?;
    out.flush()
}

/// Why standard output has not been written.
pub fn not_printed(error: &io::Error) -> Diagnostic {
    failed("written", Path::new(STANDARD), error)
}

fn failed(verb: &str, path: &Path, error: &io::Error) -> Diagnostic {
    use io::ErrorKind::*;
    let reason = match error.kind() {
        NotFound if verb == "read" => "there is no such file".to_owned(),
        NotFound => "there is no such directory".to_owned(),
        IsADirectory => "it is a directory".to_owned(),
        NotADirectory => "a part of the path is no directory".to_owned(),
        PermissionDenied => "permission is denied".to_owned(),
        StorageFull => "the disk is full".to_owned(),
        BrokenPipe => "the reader has gone".to_owned(),
        _ => error.to_string(),
    };
    let shown = if is_standard(path) { "standard output".to_owned() } else { format!("`{}`", show(path)) };
    Diagnostic::new(Code::Unreadable, format!("{shown} cannot be {verb}: {reason}"))
}
