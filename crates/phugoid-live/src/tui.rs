//! The terminal view: the documents of a live estimation as a table, for those who are on ssh.

mod course;
mod draw;
mod number;
mod state;

use std::io;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::time::{Duration, Instant};

use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use crate::audience::Audience;
use crate::document::Kind;
use crate::stop::{Stop, Why};
pub use state::State;

/// Documents that wait for the screen.
const WAITING: usize = 256;
/// Time between two pictures; a terminal over ssh takes no more.
const PICTURE: Duration = Duration::from_millis(100);

/// Gets the documents for the screen.
pub struct Listener(SyncSender<String>);

impl Audience for Listener {
    fn hear(&mut self, kind: Kind, document: &str) {
        if kind.is_shown() {
            // Where the screen is slow, or closed, a document is left out: the flight waits for neither.
            let _ = self.0.try_send(document.to_owned());
        }
    }
}

/// The listener to be handed to the estimation, and the documents that it gets.
pub fn channel() -> (Listener, Receiver<String>) {
    let (send, receive) = mpsc::sync_channel(WAITING);
    (Listener(send), receive)
}

/// Shows the documents on the terminal until `q` or Ctrl-C is pressed, which sets `stop`, or until `stop` is set and no more
/// documents come. Takes the whole screen meanwhile and gives it back in any case.
///
/// # Errors
/// The terminal cannot be read or written.
pub fn run(documents: &Receiver<String>, stop: &Stop) -> io::Result<()> {
    let mut terminal = ratatui::try_init()?;
    let result = show(&mut terminal, documents, stop);
    ratatui::try_restore()?;
    stop.ask(Why::ViewLeft);
    result
}

fn show(terminal: &mut ratatui::DefaultTerminal, documents: &Receiver<String>, stop: &Stop) -> io::Result<()> {
    let mut state = State::default();
    loop {
        let now = Instant::now();
        let open = take(documents, &mut state, now + PICTURE);
        terminal.draw(|frame| draw::draw(frame, &state, Instant::now()))?;
        while event::poll(Duration::ZERO)? {
            if let Event::Key(key) = event::read()?
                && leaves(key, &mut state)
            {
                return Ok(());
            }
        }
        if !open {
            // What was told last stays on the screen until a key is pressed, unless the program is to stop.
            if stop.asked().is_some() && !state.has_ended() {
                return Ok(());
            }
            std::thread::sleep(PICTURE);
        }
    }
}

/// Takes what comes until `until`; false where nothing can come any more.
fn take(documents: &Receiver<String>, state: &mut State, until: Instant) -> bool {
    loop {
        match documents.recv_timeout(until.saturating_duration_since(Instant::now())) {
            Ok(document) => state.take(&document, Instant::now()),
            Err(RecvTimeoutError::Timeout) => return true,
            Err(RecvTimeoutError::Disconnected) => return false,
        }
    }
}

/// Does what a key says; true where the view is to be left.
fn leaves(key: KeyEvent, state: &mut State) -> bool {
    if key.kind == KeyEventKind::Release {
        return false;
    }
    match key.code {
        KeyCode::Char('q') => return true,
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => return true,
        KeyCode::Char(' ') => state.pause(),
        KeyCode::Down | KeyCode::Char('j') => state.scroll(1),
        KeyCode::Up | KeyCode::Char('k') => state.scroll(-1),
        _ => {}
    }
    false
}
