//! The built program in a folder of its own.

#![cfg_attr(
    not(feature = "sim"),
    allow(dead_code, reason = "lots need the simulated rig")
)]

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
#[cfg(all(feature = "sim", unix))]
use std::process::{Child, Stdio};

/// A fresh folder for the files of commands; it stays after the test.
pub struct Workshop {
    /// Working directory of the program.
    pub folder: PathBuf,
}

/// Result of a command.
#[derive(Debug)]
pub struct Said {
    /// Exit status.
    pub status: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Workshop {
    /// Makes a folder with the configuration; each test has its own `name`.
    pub fn new(name: &str) -> Self {
        let workshop = Self::empty(name);
        copy(
            &Path::new(env!("CARGO_MANIFEST_DIR")).join("config"),
            &workshop.folder.join("config"),
        );
        workshop
    }

    /// Makes an empty folder; each test has its own `name`.
    pub fn empty(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
            .join("line")
            .join(name);
        if folder.exists() {
            fs::remove_dir_all(&folder).unwrap();
        }
        fs::create_dir_all(&folder).unwrap();
        Self { folder }
    }

    /// Runs `relayrig` with the words of `line`, separated by spaces.
    pub fn run(&self, line: &str) -> Said {
        said(&self.command(line).output().unwrap())
    }

    /// As [`Self::run`], with stdout closed.
    #[cfg(all(feature = "sim", unix))]
    pub fn run_unread(&self, line: &str) -> Said {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let started = self
            .command(line)
            .stdout(writer)
            .stderr(Stdio::piped())
            .spawn();
        said(&started.unwrap().wait_with_output().unwrap())
    }

    /// As [`Self::run`], with a limit on the size of files, in blocks of the shell.
    #[cfg(all(feature = "sim", unix))]
    pub fn run_with_little_room(&self, blocks: u32, line: &str) -> Said {
        said(&self.with_little_room(blocks, line).output().unwrap())
    }

    /// As [`Self::start_logging`], with a limit on the size of files, in blocks of the shell.
    #[cfg(all(feature = "sim", unix))]
    pub fn start_with_little_room(&self, blocks: u32, line: &str) -> Child {
        let mut command = self.with_little_room(blocks, line);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command.spawn().unwrap()
    }

    #[cfg(all(feature = "sim", unix))]
    fn with_little_room(&self, blocks: u32, line: &str) -> Command {
        // Without the trap the system would kill the program instead of refusing the write.
        let mut shell = Command::new("sh");
        shell.args(["-c", "trap '' XFSZ; ulimit -S -f \"$0\"; exec \"$@\""]);
        shell.arg(blocks.to_string());
        shell.arg(env!("CARGO_BIN_EXE_relayrig"));
        self.worded(shell, line)
    }

    /// Starts `relayrig` without its log.
    #[cfg(all(feature = "sim", unix))]
    pub fn start(&self, line: &str) -> Child {
        self.started(line, Stdio::piped(), Stdio::null())
    }

    /// Starts `relayrig` with its log but without its data.
    #[cfg(all(feature = "sim", unix))]
    pub fn start_logging(&self, line: &str) -> Child {
        self.started(line, Stdio::null(), Stdio::piped())
    }

    /// Starts `relayrig` with data and log.
    #[cfg(all(feature = "sim", unix))]
    pub fn start_heard(&self, line: &str) -> Child {
        self.started(line, Stdio::piped(), Stdio::piped())
    }

    #[cfg(all(feature = "sim", unix))]
    fn started(&self, line: &str, data: Stdio, logs: Stdio) -> Child {
        let mut command = self.command(line);
        command.stdout(data).stderr(logs).spawn().unwrap()
    }

    /// As [`Self::start`], with a time limit, s.
    #[cfg(all(feature = "sim", unix))]
    pub fn start_for(&self, seconds: &str, line: &str) -> Child {
        let mut command = Command::new("timeout");
        command.args([seconds, env!("CARGO_BIN_EXE_relayrig")]);
        self.worded(command, line)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    }

    /// As [`Self::run`], with an interrupt after a time, s.
    #[cfg(all(feature = "sim", unix))]
    pub fn run_interrupted(&self, seconds: &str, line: &str) -> Said {
        let mut command = Command::new("timeout");
        command.args(["--preserve-status", "--signal", "INT", seconds]);
        command.arg(env!("CARGO_BIN_EXE_relayrig"));
        said(&self.worded(command, line).output().unwrap())
    }

    /// Returns the command of `relayrig` with the words of `line`.
    pub fn command(&self, line: &str) -> Command {
        self.worded(Command::new(env!("CARGO_BIN_EXE_relayrig")), line)
    }

    fn worded(&self, mut command: Command, line: &str) -> Command {
        command
            .args(["--log", "warn"])
            .args(line.split_whitespace())
            .current_dir(&self.folder);
        command
    }

    /// Reads a file.
    pub fn read(&self, file: &str) -> String {
        fs::read_to_string(self.folder.join(file)).unwrap()
    }

    /// Writes a file.
    pub fn write(&self, file: &str, text: &str) {
        fs::write(self.folder.join(file), text).unwrap();
    }

    /// Returns true when the file exists.
    pub fn has(&self, file: &str) -> bool {
        self.folder.join(file).exists()
    }

    /// Replaces the only `from` in `file` by `to` and returns its line.
    pub fn change(&self, file: &str, from: &str, to: &str) -> usize {
        let text = self.read(file);
        let found: Vec<usize> = text.match_indices(from).map(|(at, _)| at).collect();
        assert_eq!(found.len(), 1, "{file}: expected {from:?} once");
        self.write(file, &text.replace(from, to));
        text[..found[0]].matches('\n').count() + 1
    }

    /// Returns a number from the history.
    pub fn count(&self, query: &str) -> i64 {
        let history = rusqlite::Connection::open(self.folder.join("relayrig.db")).unwrap();
        history.query_row(query, [], |row| row.get(0)).unwrap()
    }

    /// Checks that each part of `output` with a bin has one row with this bin; returns the number of these parts.
    #[cfg(all(feature = "sim", unix))]
    pub fn landed_parts_with_rows(&self, output: &[Value]) -> usize {
        let landed = |it: &&Value| it["type"] == "part" && it["bin"] != "";
        let check = |part: &Value| {
            let (seq, bin) = (&part["seq"], part["bin"].as_str().unwrap());
            let rows = format!(
                "SELECT count(*) FROM part WHERE kind = 'lot' AND seq = {seq} AND bin = '{bin}'"
            );
            assert_eq!(self.count(&rows), 1, "{part}");
        };
        output.iter().filter(landed).map(check).count()
    }

    /// Returns a column of texts from the history.
    pub fn texts(&self, query: &str) -> Vec<String> {
        let history = rusqlite::Connection::open(self.folder.join("relayrig.db")).unwrap();
        let mut rows = history.prepare(query).unwrap();
        let texts = rows.query_map([], |row| row.get(0)).unwrap();
        texts.collect::<Result<_, _>>().unwrap()
    }
}

fn said(output: &std::process::Output) -> Said {
    Said {
        status: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8(output.stdout.clone()).unwrap(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// Attempts at a run at real pace on a computer that other tests keep busy.
#[cfg(all(feature = "sim", unix))]
pub const ATTEMPTS: usize = 5;

impl Said {
    /// Checks the exit status and returns the result.
    pub fn with_status(self, expected: i32) -> Self {
        assert_eq!(self.status, expected, "{self}");
        self
    }

    /// Returns true when an alarm ended the run and its summary says that this computer was late by more than 20 ms:
    /// other tests keep it busy, and the run may be repeated.
    pub fn ended_late(&self) -> bool {
        if self.status != 3 {
            return false;
        }
        let summary = self.objects().pop().unwrap();
        summary["lateness"]["worst_ms"].as_f64().unwrap() > 20.0
    }

    /// Parses standard output as JSON lines.
    pub fn objects(&self) -> Vec<Value> {
        objects(&self.stdout)
    }
}

impl std::fmt::Display for Said {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "status {}\n--- stdout\n{}--- stderr\n{}",
            self.status, self.stdout, self.stderr
        )
    }
}

/// Parses JSON lines.
pub fn objects(text: &str) -> Vec<Value> {
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

/// Copies a folder with all that it holds.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).unwrap();
        }
    }
}
