//! Files are written whole or not at all.
use covact::output::OutputError;
use covact::output::atomic::{
    Sink, make_folder, write_fully, write_soon, write_through, write_whole, write_whole_with,
};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// Takes at most three bytes at a time, is interrupted now and then, and fails once `room` is used up.
struct Grudging<W> {
    inner: W,
    room: usize,
    calls: usize,
}

impl<W: Write> Write for Grudging<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.calls += 1;
        if self.calls.is_multiple_of(5) {
            return Err(io::ErrorKind::Interrupted.into());
        }
        let n = bytes.len().min(3).min(self.room);
        if n == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.room -= n;
        self.inner.write_all(&bytes[..n])?;
        Ok(n)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<W: Write> Sink for Grudging<W> {
    fn sync(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// Takes everything and fails when asked to put it on the disk, as network file systems do.
struct FailsLate {
    inner: File,
    on_sync: bool,
}

impl Write for FailsLate {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.inner.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        if self.on_sync {
            Ok(())
        } else {
            Err(io::ErrorKind::StorageFull.into())
        }
    }
}

impl Sink for FailsLate {
    fn sync(&mut self) -> io::Result<()> {
        Err(io::ErrorKind::QuotaExceeded.into())
    }
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

fn pattern(n: usize) -> Vec<u8> {
    (0..n).map(|i| (i * 31 % 251) as u8).collect()
}

#[test]
fn a_sink_that_writes_short_gets_every_byte() {
    let bytes = pattern(10_007);
    let mut sink = Grudging {
        inner: Vec::new(),
        room: usize::MAX,
        calls: 0,
    };
    write_fully(&mut sink, &bytes).unwrap();
    assert!(sink.inner == bytes);
    assert!(sink.calls > bytes.len() / 3);
}

#[test]
fn a_file_is_replaced_and_nothing_stays_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtu");
    write_whole(&path, b"first").unwrap();
    write_whole(&path, &pattern(100_000)).unwrap();
    assert!(fs::read(&path).unwrap() == pattern(100_000));
    assert_eq!(names(folder.path()), ["a.vtu"]);
}

#[test]
fn a_disk_that_fills_leaves_the_earlier_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.pvd");
    write_whole(&path, b"earlier").unwrap();
    let error = write_whole_with(&path, &pattern(5000), |temporary| {
        Ok(Grudging {
            inner: File::create_new(temporary)?,
            room: 4000,
            calls: 0,
        })
    })
    .unwrap_err();
    assert!(error.is_disk_full());
    let text = error.to_string();
    assert!(
        text.contains("results.pvd") && text.contains("the disk is full"),
        "{text}"
    );
    assert_eq!(fs::read(&path).unwrap(), b"earlier");
    assert_eq!(names(folder.path()), ["results.pvd"]);
}

#[test]
fn errors_of_flush_and_sync_count() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new.csv");
    for (on_sync, word) in [(false, "the disk is full"), (true, "quota")] {
        let error = write_whole_with(&path, b"abc", |temporary| {
            Ok(FailsLate {
                inner: File::create_new(temporary)?,
                on_sync,
            })
        })
        .unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
        assert!(names(folder.path()).is_empty());
    }
}

/// The kernel's own full device.
#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("body_0001.vtu");
    write_whole(&path, b"earlier").unwrap();
    // One byte: a small file must not slip through a buffer.
    let error = write_whole_with(&path, b"x", |temporary| {
        File::create_new(temporary)?;
        File::options().write(true).open("/dev/full")
    })
    .unwrap_err();
    let OutputError::Io { reason, source, .. } = &error else {
        panic!("{error:?}");
    };
    assert_eq!(source.raw_os_error(), Some(28));
    assert!(
        reason.contains("the disk is full") && reason.contains("No space left"),
        "{reason}"
    );
    assert_eq!(fs::read(&path).unwrap(), b"earlier");
    assert_eq!(names(folder.path()), ["body_0001.vtu"]);
}

#[cfg(unix)]
#[test]
fn what_is_not_a_file_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("inner");
    make_folder(&inner).unwrap();
    make_folder(&inner).unwrap();
    for path in [inner.as_path(), Path::new("/dev/null")] {
        let error = write_whole(path, b"x").unwrap_err();
        assert!(matches!(error, OutputError::NotAFile { .. }), "{error:?}");
    }
    // A link is replaced, and what it points to stays: a file, a folder, nothing.
    let (target, link) = (inner.join("real.csv"), folder.path().join("link.csv"));
    type Writer = fn(&Path, &[u8]) -> Result<(), OutputError>;
    let writers: [Writer; 2] = [write_whole, write_soon];
    for write in writers {
        fs::write(&target, "old").unwrap();
        for to in [target.as_path(), inner.as_path(), Path::new("nowhere")] {
            let _ = fs::remove_file(&link);
            std::os::unix::fs::symlink(to, &link).unwrap();
            write(&link, b"new").unwrap();
            assert!(fs::symlink_metadata(&link).unwrap().is_file());
            assert_eq!(fs::read(&link).unwrap(), b"new");
        }
        assert_eq!(fs::read(&target).unwrap(), b"old");
    }
    assert_eq!(names(&inner), ["real.csv"]);
    // A file that the user names is where the link says.
    fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink(&target, &link).unwrap();
    write_through(&link, b"new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&target).unwrap(), b"new");
}

#[test]
fn a_missing_folder_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("absent").join("a.json");
    let text = write_whole(&path, b"x").unwrap_err().to_string();
    assert!(
        text.contains("a.json") && text.contains("no such file or folder"),
        "{text}"
    );
    let file = folder.path().join("file");
    fs::write(&file, "x").unwrap();
    let text = make_folder(&file.join("out")).unwrap_err().to_string();
    assert!(text.contains("cannot create the folder"), "{text}");
}
