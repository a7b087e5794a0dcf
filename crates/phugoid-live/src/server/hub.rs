//! What clients get: a bounded past for newcomers, and the newest for everybody.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard};

use tokio::sync::watch;

use crate::document::Kind;
use crate::run::Audience;

/// Documents behind which a client may be; one that is further behind goes on with the newest.
const RECENT: usize = 256;
/// Estimates of the past, at most; beyond it every second one goes, and half as many are added from then on. However long the
/// flight, a newcomer sees all of it.
const PAST: usize = 1200;
/// Events of the past.
const EVENTS: usize = 200;

/// Shared by the estimation, which fills it, and the clients.
#[derive(Clone)]
pub struct Hub {
    documents: Arc<Mutex<Documents>>,
    changed: watch::Sender<u64>,
}

#[derive(Default)]
struct Documents {
    /// Number of the next document.
    next: u64,
    recent: VecDeque<(u64, Arc<str>)>,
    hello: Option<Arc<str>>,
    link: Option<Arc<str>>,
    end: Option<Arc<str>>,
    events: VecDeque<Arc<str>>,
    past: Vec<Arc<str>>,
    /// Every how many estimates one is kept for the past, and how many came since the last.
    stride: usize,
    since: usize,
    estimate: Option<Arc<str>>,
}

impl Default for Hub {
    fn default() -> Self {
        Self { documents: Arc::default(), changed: watch::Sender::new(0) }
    }
}

impl Hub {
    /// Takes a document.
    pub fn publish(&self, kind: Kind, document: &str) {
        if kind == (Kind::Estimate { shown: false }) {
            return;
        }
        let mut documents = self.lock();
        documents.add(kind, document.into());
        let next = documents.next;
        drop(documents);
        self.changed.send_replace(next);
    }

    /// What a newcomer gets, and the place from which it goes on.
    pub(super) fn newcomer(&self) -> (Vec<Arc<str>>, u64) {
        let documents = self.lock();
        let past = documents.hello.iter().chain(&documents.events).chain(&documents.past);
        let newest = documents.estimate.iter().chain(&documents.link).chain(&documents.end);
        (past.chain(newest).cloned().collect(), documents.next)
    }

    /// What came since a place, and how many documents are lost to a client that was too slow; moves the place on.
    pub(super) fn since(&self, place: &mut u64) -> (Vec<Arc<str>>, u64) {
        let documents = self.lock();
        let oldest = documents.recent.front().map_or(documents.next, |(number, _)| *number);
        let mut lost = oldest.saturating_sub(*place);
        let mut from = *place;
        if lost > 0 {
            // The newest, not the oldest that is left: a client that is slow would stay so.
            from = documents.next.saturating_sub(1);
            lost = from.saturating_sub(*place);
        }
        *place = documents.next;
        let news = documents.recent.iter().filter(|(number, _)| *number >= from).map(|(_, text)| Arc::clone(text));
        (news.collect(), lost)
    }

    pub(super) fn watch(&self) -> watch::Receiver<u64> {
        self.changed.subscribe()
    }

    /// The latest of everything, as one JSON object.
    pub(super) fn snapshot(&self) -> String {
        let documents = self.lock();
        let part = |name: &str, text: &Option<Arc<str>>| format!("\"{name}\":{}", text.as_deref().unwrap_or("null"));
        format!(
            "{{{},{},{},{}}}",
            part("hello", &documents.hello),
            part("estimate", &documents.estimate),
            part("link", &documents.link),
            part("end", &documents.end)
        )
    }

    fn lock(&self) -> MutexGuard<'_, Documents> {
        // Nothing in here panics; if it did, what is there is still whole documents.
        self.documents.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Audience for Hub {
    fn hear(&mut self, kind: Kind, document: &str) {
        self.publish(kind, document);
    }
}

impl Documents {
    fn add(&mut self, kind: Kind, document: Arc<str>) {
        match kind {
            Kind::Hello => {
                // Another flight: its estimates have nothing to do with those before.
                (self.past, self.stride, self.since, self.estimate) = (Vec::new(), 1, 0, None);
                self.hello = Some(Arc::clone(&document));
            }
            Kind::Estimate { .. } => {
                self.since += 1;
                if self.since >= self.stride {
                    self.since = 0;
                    self.past.push(Arc::clone(&document));
                }
                if self.past.len() > PAST {
                    let mut keep = false;
                    self.past.retain(|_| {
                        keep = !keep;
                        keep
                    });
                    self.stride *= 2;
                }
                self.estimate = Some(Arc::clone(&document));
            }
            Kind::Event => {
                self.events.push_back(Arc::clone(&document));
                if self.events.len() > EVENTS {
                    self.events.pop_front();
                }
            }
            Kind::Link => self.link = Some(Arc::clone(&document)),
            Kind::End => self.end = Some(Arc::clone(&document)),
        }
        self.recent.push_back((self.next, document));
        self.next += 1;
        if self.recent.len() > RECENT {
            self.recent.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_past_is_bounded_and_whole() {
        let hub = Hub::default();
        hub.publish(Kind::Hello, "hello");
        for k in 0..360_000 {
            hub.publish(Kind::Estimate { shown: true }, &k.to_string());
            hub.publish(Kind::Estimate { shown: false }, "not for pages");
        }
        let (past, _) = hub.newcomer();
        assert!(past.len() <= PAST + 3, "{}", past.len());
        let numbers: Vec<u32> = past.iter().filter_map(|text| text.parse().ok()).collect();
        assert_eq!((numbers[0], numbers[numbers.len() - 1]), (0, 359_999));
        // Evenly, but for the last, which is the newest whatever the stride.
        let step = numbers[1] - numbers[0];
        assert!(numbers.windows(2).rev().skip(1).all(|pair| pair[1] - pair[0] == step));
    }

    #[test]
    fn a_slow_client_goes_on_with_the_newest() {
        let hub = Hub::default();
        let (_, mut place) = hub.newcomer();
        (0..10).for_each(|k| hub.publish(Kind::Event, &k.to_string()));
        let (news, lost) = hub.since(&mut place);
        assert_eq!((news.len(), lost), (10, 0));
        (10..2010).for_each(|k| hub.publish(Kind::Event, &k.to_string()));
        let (news, lost) = hub.since(&mut place);
        assert_eq!((news.iter().map(|text| &**text).collect::<Vec<_>>(), lost), (vec!["2009"], 1999));
        assert_eq!(hub.since(&mut place), (vec![], 0));
    }
}
