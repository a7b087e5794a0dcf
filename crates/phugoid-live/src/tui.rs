//! The terminal view: the documents of a live estimation as a table, for work over ssh.

mod draw;
mod number;
mod sparkline;
mod state;

use std::io;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::time::{Duration, Instant};

use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use crate::audience::Audience;
use crate::document::DocumentKind;
use crate::stop::{Stop, Why};
pub use state::State;

/// Documents that may wait for the screen; further ones are left out.
const WAITING: usize = 256;
/// Time between two redraws. More would be too much for a terminal over ssh.
const REDRAW_INTERVAL: Duration = Duration::from_millis(100);

/// Passes the documents on to the terminal view.
pub struct Listener(SyncSender<String>);

impl Audience for Listener {
    fn hear(&mut self, kind: DocumentKind, document: &str) {
        if kind.is_shown() {
            // If the screen is slow or closed, the document is left out, because the estimation must not wait.
            let _ = self.0.try_send(document.to_owned());
        }
    }
}

/// A listener for the estimation, and the end at which [`run`] receives its documents.
pub fn channel() -> (Listener, Receiver<String>) {
    let (send, receive) = mpsc::sync_channel(WAITING);
    (Listener(send), receive)
}

/// Shows the documents on the terminal until `q` or Ctrl-C is pressed, which sets `stop`, or until `stop` is set and no
/// more documents come. It uses the whole screen and restores it at the end, also after an error.
///
/// # Errors
/// What the operating system says if the terminal cannot be read or written.
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
        let open = take(documents, &mut state, now + REDRAW_INTERVAL);
        terminal.draw(|frame| draw::draw(frame, &state, Instant::now()))?;
        while event::poll(Duration::ZERO)? {
            if let Event::Key(key) = event::read()?
                && handle_key(key, &mut state)
            {
                return Ok(());
            }
        }
        if !open {
            // The last state stays on the screen until a key is pressed, unless the program has to stop.
            if stop.asked().is_some() && !state.has_ended() {
                return Ok(());
            }
            std::thread::sleep(REDRAW_INTERVAL);
        }
    }
}

/// Takes the documents that come until the time `until`; false if no more can come.
fn take(documents: &Receiver<String>, state: &mut State, until: Instant) -> bool {
    loop {
        match documents.recv_timeout(until.saturating_duration_since(Instant::now())) {
            Ok(document) => state.take(&document, Instant::now()),
            Err(RecvTimeoutError::Timeout) => return true,
            Err(RecvTimeoutError::Disconnected) => return false,
        }
    }
}

/// Handles a key; true if the view has to be left.
fn handle_key(key: KeyEvent, state: &mut State) -> bool {
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
