//! Files that are there whole or not at all.
//!
//! A result is written to a temporary file in the folder of its target, and takes the name of the target only once all
//! of it is on the disk. Whoever stops in between, by an error or by a kill, leaves the target as it was. A kill also
//! leaves the temporary file: [`remove_abandoned`] finds and removes it.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// What the names of temporary files begin and end with; between them stand the number of the process and a count.
const BEGINNING: &str = ".phugoid-";
const ENDING: &str = ".part";
/// A temporary file that was written to more recently is never taken for abandoned.
const AT_REST: Duration = Duration::from_secs(60);

/// A file that is being written. Without [`OutputFile::finish`] nothing of it stays.
///
/// Standard output (`/dev/stdout`), pipes and devices are written directly, since nothing can take their place.
///
/// ```
/// use std::io::Write;
///
/// use phugoid_flight_data::output_file::OutputFile;
///
/// let path = std::env::temp_dir().join(format!("phugoid-output-{}.txt", std::process::id()));
/// let mut file = OutputFile::create(&path)?;
/// file.write_all(b"half")?;
/// drop(file);
/// assert!(!path.exists());
///
/// let mut file = OutputFile::create(&path)?;
/// file.write_all(b"whole")?;
/// file.finish()?;
/// assert_eq!(std::fs::read(&path)?, b"whole");
/// std::fs::remove_file(&path)?;
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct OutputFile {
    writer: BufWriter<File>,
    /// The temporary file and the target that it becomes; `None` if the target is written directly.
    renamed: Option<(PathBuf, PathBuf)>,
}

impl OutputFile {
    /// Begins a file with this path. An existing file keeps its content until [`OutputFile::finish`], and its
    /// permissions beyond that; of a link the file behind it is written.
    ///
    /// # Errors
    /// What the operating system says: no such folder, a folder in place of a file, no permission. A file that may not
    /// be written is not replaced either.
    pub fn create(path: &Path) -> io::Result<Self> {
        let existing = fs::metadata(path).ok();
        let dangling = existing.is_none() && fs::symlink_metadata(path).is_ok();
        let special = existing.as_ref().is_some_and(|existing| !existing.is_file());
        // What /dev/stdout stands for may be a file that somebody else has opened and goes on writing.
        let of_system = (path.starts_with("/dev") && !path.starts_with("/dev/shm")) || path.starts_with("/proc");
        if special || dangling || of_system {
            return Ok(Self { writer: BufWriter::new(File::create(path)?), renamed: None });
        }
        if existing.as_ref().is_some_and(|existing| existing.permissions().readonly()) {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        let target = if existing.is_some() { fs::canonicalize(path)? } else { path.to_owned() };
        let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let (file, temporary) = temporary(folder)?;
        let this = Self { writer: BufWriter::new(file), renamed: Some((temporary, target)) };
        if let Some(existing) = existing {
            this.writer.get_ref().set_permissions(existing.permissions())?;
        }
        Ok(this)
    }

    /// Puts everything on the disk and gives the file its name.
    ///
    /// # Errors
    /// What the operating system says, such as that the disk is full. The target is then as it was before.
    pub fn finish(mut self) -> io::Result<()> {
        self.writer.flush()?;
        let Some((temporary, target)) = &self.renamed else { return Ok(()) };
        self.writer.get_ref().sync_all()?;
        fs::rename(temporary, target)?;
        self.renamed = None;
        Ok(())
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        if let Some((temporary, _)) = &self.renamed {
            // There is nobody to tell, and the target is as it was.
            let _ = fs::remove_file(temporary);
        }
    }
}

/// A new file in a folder, under a name that no other has.
fn temporary(folder: &Path) -> io::Result<(File, PathBuf)> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    loop {
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!("{BEGINNING}{}-{number}{ENDING}", std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => {
                // Tells others that somebody writes it, until the file is closed or the program ends, however that
                // happens. Where a file system has no locks, what is left is never removed: see `is_abandoned`.
                let _ = file.try_lock();
                return Ok((file, path));
            }
            // Left by a program that was killed and had the same number.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// Removes the temporary files in a folder that killed programs have left, and gives their paths. They hold a part of a
/// result that never was one; what it was made from is not touched.
///
/// A file that another program writes at this moment stays, also if it runs on another machine: it holds a lock of the
/// file. So do files that were changed within the last minute, those on a file system without locks, and links. What
/// cannot be read or removed is left where it is.
pub fn remove_abandoned(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let paths = entries.filter(|entry| entry.file_name().to_str().is_some_and(is_temporary)).map(|entry| entry.path());
    let mut removed: Vec<PathBuf> = paths.filter(|path| is_abandoned(path) && fs::remove_file(path).is_ok()).collect();
    removed.sort();
    removed
}

/// Whether a file name is one of [`temporary`].
fn is_temporary(name: &str) -> bool {
    let numbers = name.strip_prefix(BEGINNING).and_then(|rest| rest.strip_suffix(ENDING));
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    numbers
        .and_then(|numbers| numbers.split_once('-'))
        .is_some_and(|(process, count)| is_number(process) && is_number(count))
}

/// Whether nobody writes a temporary file any more.
fn is_abandoned(path: &Path) -> bool {
    let of_file = |file: &fs::Metadata| {
        let changed = file.modified().ok().and_then(|changed| changed.elapsed().ok());
        file.is_file() && changed.is_some_and(|since| since >= AT_REST)
    };
    fs::symlink_metadata(path).is_ok_and(|file| of_file(&file))
        && OpenOptions::new().write(true).open(path).is_ok_and(|file| file.try_lock().is_ok())
}

/// Writes a whole file, as [`OutputFile`] does.
///
/// # Errors
/// As [`OutputFile::create`] and [`OutputFile::finish`].
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    let mut file = OutputFile::create(path)?;
    file.write_all(content.as_ref())?;
    file.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("phugoid-output-{name}-{}", std::process::id()));
            let _ = fs::remove_dir_all(&path);
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        fn names(&self) -> Vec<String> {
            let entries = fs::read_dir(&self.0).unwrap();
            let mut names: Vec<String> =
                entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_file_that_is_not_finished_leaves_everything_as_it_was() {
        let folder = Folder::new("half");
        let path = folder.0.join("a.txt");
        fs::write(&path, "old").unwrap();
        let mut half = OutputFile::create(&path).unwrap();
        half.write_all(&[b'x'; 100_000]).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        drop(half);
        assert_eq!((fs::read(&path).unwrap(), folder.names()), (b"old".to_vec(), vec!["a.txt".to_owned()]));
        write(&path, "new").unwrap();
        assert_eq!((fs::read(&path).unwrap(), folder.names()), (b"new".to_vec(), vec!["a.txt".to_owned()]));
        // A target that cannot be replaced: nothing stays beside it.
        fs::create_dir(folder.0.join("d")).unwrap();
        assert!(write(&folder.0.join("d"), "x").is_err());
        assert!(write(&folder.0.join("none/a.txt"), "x").is_err());
        assert_eq!(folder.names(), ["a.txt", "d"]);
    }

    /// Sets the time at which a file was changed last.
    fn age(path: &Path, seconds: u64) {
        let file = OpenOptions::new().write(true).open(path).unwrap();
        file.set_modified(std::time::SystemTime::now() - Duration::from_secs(seconds)).unwrap();
    }

    #[test]
    fn what_a_killed_program_has_left_is_removed_and_nothing_else() {
        let folder = Folder::new("abandoned");
        let others =
            [".phugoid-1-2.part.txt", ".phugoid-1.part", ".phugoid-a-2.part", "phugoid-1-2.part", ".phugoid-1-.part"];
        for name in [".phugoid-1-0.part", ".phugoid-99-7.part", ".phugoid-5-5.part"].iter().chain(&others) {
            fs::write(folder.0.join(name), "half").unwrap();
            age(&folder.0.join(name), 3600);
        }
        // Changed just now: perhaps its writer has not locked it yet.
        age(&folder.0.join(".phugoid-5-5.part"), 10);
        fs::create_dir(folder.0.join(".phugoid-6-6.part")).unwrap();
        // Somebody writes this one, however long ago the last byte came.
        let mut writing = OutputFile::create(&folder.0.join("result.txt")).unwrap();
        let temporary = writing.renamed.as_ref().unwrap().0.clone();
        age(&temporary, 3600);
        let expected = [".phugoid-1-0.part", ".phugoid-99-7.part"].map(|name| folder.0.join(name));
        assert_eq!(remove_abandoned(&folder.0), expected);
        writing.write_all(b"whole").unwrap();
        writing.finish().unwrap();
        let mut left: Vec<&str> = others.to_vec();
        left.extend([".phugoid-5-5.part", ".phugoid-6-6.part", "result.txt"]);
        left.sort_unstable();
        assert_eq!(folder.names(), left);
        assert!(remove_abandoned(&folder.0).is_empty() && remove_abandoned(&folder.0.join("none")).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn links_permissions_and_devices_stay_what_they_are() {
        use std::os::unix::fs::{PermissionsExt, symlink};

        let folder = Folder::new("links");
        let (file, link) = (folder.0.join("file"), folder.0.join("link"));
        fs::write(&file, "old").unwrap();
        fs::set_permissions(&file, PermissionsExt::from_mode(0o640)).unwrap();
        symlink("file", &link).unwrap();
        write(&link, "new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
        fs::set_permissions(&file, PermissionsExt::from_mode(0o440)).unwrap();
        assert_eq!(write(&file, "newer").unwrap_err().kind(), io::ErrorKind::PermissionDenied);
        write(Path::new("/dev/null"), "away").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
        assert_eq!(folder.names(), ["file", "link"]);
    }
}
