//! `phugoid live` while it runs.

// Each test file uses a part; what goes wrong here fails the test.
#![allow(dead_code, clippy::unwrap_used, clippy::panic)]

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

use serde_json::Value;

/// A program that says nothing for so long, or has not ended then, has gone wrong.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running `phugoid live`, killed at the end of the test.
pub(crate) struct Live {
    program: Child,
    input: Option<ChildStdin>,
    documents: Receiver<String>,
    said: Receiver<String>,
    hello: Option<String>,
    started: Instant,
}

impl Live {
    /// Starts it on the built-in F-16, with every estimate on its lines.
    pub(crate) fn start(folder: &Path, arguments: &[&str]) -> Self {
        let mut program = Command::new(env!("CARGO_BIN_EXE_phugoid"));
        program.arg("live");
        Self::run(&mut program, folder, arguments)
    }

    /// The same with a limit of the size of its files, which [`Live::limit_files`] sets later: a write beyond it fails, as
    /// on a full disk, and does not end the program.
    pub(crate) fn start_with_limited_files(folder: &Path, arguments: &[&str]) -> Self {
        let mut program = Command::new("sh");
        program.args(["-c", "trap '' XFSZ; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_phugoid"), "live"]);
        Self::run(&mut program, folder, arguments)
    }

    fn run(program: &mut Command, folder: &Path, arguments: &[&str]) -> Self {
        let mut program = program
            .args(arguments)
            .args(["--model", "f16", "--all"])
            .current_dir(folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let input = program.stdin.take();
        let documents = lines(program.stdout.take().unwrap());
        let said = lines(program.stderr.take().unwrap());
        Self { program, input, documents, said, hello: None, started: Instant::now() }
    }

    pub(crate) fn input(&mut self, bytes: &[u8]) {
        self.input.as_mut().unwrap().write_all(bytes).unwrap();
    }

    pub(crate) fn end_input(&mut self) {
        self.input = None;
    }

    fn next(&self) -> Option<String> {
        assert!(self.started.elapsed() < PATIENCE, "it has not ended");
        match self.documents.recv_timeout(PATIENCE) {
            Ok(document) => Some(document),
            Err(mpsc::RecvTimeoutError::Disconnected) => None,
            Err(mpsc::RecvTimeoutError::Timeout) => panic!("no document for {PATIENCE:?}"),
        }
    }

    /// Where it receives from: told in the first document, when the source has been opened.
    pub(crate) fn source(&mut self) -> String {
        if self.hello.is_none() {
            self.hello = self.next();
        }
        let hello = json(self.hello.as_ref().unwrap());
        hello["source"].as_str().unwrap().to_owned()
    }

    /// The address at which it listens.
    pub(crate) fn address(&mut self) -> String {
        let source = self.source();
        source.split_once("://").unwrap().1.to_owned()
    }

    /// Where the page is, and its token.
    pub(crate) fn page(&self) -> (String, Option<String>) {
        let said = std::iter::from_fn(|| self.said.recv_timeout(PATIENCE).ok());
        let line = said.filter_map(|line| line.strip_prefix("page: http://").map(str::to_owned)).next().unwrap();
        let (address, query) = line.split_once('/').unwrap();
        (address.to_owned(), query.strip_prefix("?token=").map(str::to_owned))
    }

    /// The documents from the first on, until the estimate of this time of the sender.
    pub(crate) fn until(&mut self, last_s: f64) -> Vec<String> {
        let mut documents: Vec<String> = self.hello.take().into_iter().collect();
        loop {
            let document = self.next().unwrap();
            let last = is_estimate(&document) && time_s(&document) >= last_s - 1e-9;
            documents.push(document);
            if last {
                return documents;
            }
        }
    }

    /// No file may become longer than so many bytes from now on.
    pub(crate) fn limit_files(&self, bytes: &str) {
        let (id, limit) = (self.program.id().to_string(), format!("--fsize={bytes}:unlimited"));
        assert!(Command::new("prlimit").args(["--pid", &id, &limit]).status().unwrap().success());
    }

    /// The documents up to the first that holds this text.
    pub(crate) fn until_said(&mut self, text: &str) -> Vec<String> {
        let mut documents: Vec<String> = self.hello.take().into_iter().collect();
        while documents.last().is_none_or(|document| !document.contains(text)) {
            documents.push(self.next().unwrap());
        }
        documents
    }

    /// Ctrl-C.
    pub(crate) fn interrupt(&self) {
        let id = self.program.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    }

    /// The documents that are left when it has ended by itself, in order.
    pub(crate) fn rest(mut self) -> Vec<String> {
        let mut documents: Vec<String> = self.hello.take().into_iter().collect();
        documents.extend(std::iter::from_fn(|| self.next()));
        let code = self.program.wait().unwrap().code();
        let said: Vec<String> = self.said.iter().collect();
        assert_eq!(code, Some(0), "{said:?}");
        documents
    }

    /// Kills it (SIGKILL) and gives what it had written before; of the last line perhaps only the beginning, which is left out.
    pub(crate) fn kill(mut self) -> Vec<String> {
        self.program.kill().unwrap();
        self.program.wait().unwrap();
        let whole = |document: &String| serde_json::from_str::<Value>(document).is_ok();
        std::iter::from_fn(|| self.next()).filter(whole).collect()
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

fn lines(from: impl Read + Send + 'static) -> Receiver<String> {
    let (send, lines) = mpsc::channel();
    std::thread::spawn(move || BufReader::new(from).lines().map_while(Result::ok).try_for_each(|line| send.send(line)));
    lines
}

pub(crate) fn json(document: &str) -> Value {
    serde_json::from_str(document).unwrap()
}

pub(crate) fn is_estimate(document: &str) -> bool {
    document.starts_with("{\"type\":\"estimate\"")
}

pub(crate) fn estimates(documents: &[String]) -> Vec<String> {
    documents.iter().filter(|document| is_estimate(document)).cloned().collect()
}

pub(crate) fn time_s(estimate: &str) -> f64 {
    json(estimate)["time_s"].as_f64().unwrap()
}

/// The status with which a server answers.
pub(crate) fn status(address: &str, path: &str, headers: &[(&str, &str)]) -> u16 {
    let mut connection = std::net::TcpStream::connect(address).unwrap();
    let host =
        if headers.iter().any(|(name, _)| *name == "Host") { String::new() } else { format!("Host: {address}\r\n") };
    let headers: String = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
    write!(connection, "GET {path} HTTP/1.1\r\n{host}{headers}\r\n").unwrap();
    let mut line = String::new();
    BufReader::new(connection).read_line(&mut line).unwrap();
    line.split(' ').nth(1).unwrap().parse().unwrap()
}
