//! The documents that clients get: a bounded past for new clients, and the newest for all.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard};

use serde_json::Value;
use tokio::sync::watch;

use crate::audience::Audience;
use crate::document::DocumentKind;

/// Documents that are kept for clients that are behind. A client that is further behind goes on with the newest.
const RECENT: usize = 256;
/// Estimates of the past that are kept at most. When there are more, every second one is removed, and from then on half
/// as many are kept. So a new client gets the whole flight, however long it is.
const PAST: usize = 1200;
/// Events of the past that are kept.
const EVENTS: usize = 200;

/// The documents, shared between the estimation, which publishes, and the clients of the server. Clones share the same
/// documents.
///
/// ```
/// use phugoid_live::document::DocumentKind;
/// use phugoid_live::server::Hub;
///
/// let hub = Hub::default();
/// hub.publish(DocumentKind::Hello, r#"{"type":"hello"}"#);
/// hub.publish(DocumentKind::Link, r#"{"type":"link","received":1}"#);
/// hub.publish(DocumentKind::Link, r#"{"type":"link","received":2}"#);
/// let latest = hub.clone().snapshot();
/// assert_eq!(latest, r#"{"hello":{"type":"hello"},"estimate":null,"link":{"type":"link","received":2},"end":null}"#);
/// ```
#[derive(Clone)]
pub struct Hub {
    documents: Arc<Mutex<Documents>>,
    changed: watch::Sender<u64>,
}

#[derive(Default)]
struct Documents {
    /// Number that the next document gets.
    next: u64,
    /// The newest documents of all kinds.
    recent: VecDeque<Numbered>,
    hello: Option<Arc<str>>,
    link: Option<Arc<str>>,
    end: Option<Arc<str>>,
    events: VecDeque<Arc<str>>,
    /// Estimates of the whole flight, evenly spaced.
    past: Vec<Numbered>,
    /// One of so many estimates is kept for the past.
    stride: usize,
    /// Estimates since the last one that was kept.
    since: usize,
    /// The newest estimate.
    estimate: Option<Numbered>,
    /// The newest estimate that holds the readiness of the parameters; it is valid for the estimates after it.
    readiness: Option<Numbered>,
}

/// A document with its number.
type Numbered = (u64, Arc<str>);

impl Default for Hub {
    fn default() -> Self {
        Self { documents: Arc::default(), changed: watch::Sender::new(0) }
    }
}

impl Hub {
    /// Adds a document and wakes the clients. Estimates that are not for the page are ignored.
    pub fn publish(&self, kind: DocumentKind, document: &str) {
        if !kind.is_shown() {
            return;
        }
        let mut documents = self.lock();
        documents.add(kind, document.into());
        let next = documents.next;
        drop(documents);
        self.changed.send_replace(next);
    }

    /// The documents for a new client, and the number of the document with which it goes on.
    pub(super) fn new_client(&self) -> (Vec<Arc<str>>, u64) {
        let documents = self.lock();
        let mut estimates: Vec<Numbered> = documents.past.clone();
        estimates.extend(documents.readiness.iter().chain(&documents.estimate).cloned());
        estimates.sort_by_key(|(number, _)| *number);
        estimates.dedup_by_key(|(number, _)| *number);
        let before = documents.hello.iter().chain(&documents.events).cloned();
        let after = documents.link.iter().chain(&documents.end).cloned();
        let all = before.chain(estimates.into_iter().map(|(_, estimate)| estimate)).chain(after);
        (all.collect(), documents.next)
    }

    /// The documents from number `place` on, and how many were left out because the client was too slow. Sets `place`
    /// to the next number.
    pub(super) fn since(&self, place: &mut u64) -> (Vec<Arc<str>>, u64) {
        let documents = self.lock();
        let oldest = documents.recent.front().map_or(documents.next, |(number, _)| *number);
        let mut lost = oldest.saturating_sub(*place);
        let mut from = *place;
        if lost > 0 {
            // It goes on with the newest document. With the oldest one that is left it would stay behind.
            from = documents.next.saturating_sub(1);
            lost = from.saturating_sub(*place);
        }
        let readiness = documents.readiness.iter().filter(|(number, _)| (*place..from).contains(number));
        let news = readiness.chain(documents.recent.iter().filter(|(number, _)| *number >= from));
        let news = news.map(|(_, text)| Arc::clone(text)).collect();
        *place = documents.next;
        (news, lost)
    }

    /// A signal that there are new documents.
    pub(super) fn watch(&self) -> watch::Receiver<u64> {
        self.changed.subscribe()
    }

    /// The latest `hello`, `estimate` (with the readiness that is valid), `link` and `end` as one JSON object; `null`
    /// for those that have not come.
    pub fn snapshot(&self) -> String {
        let documents = self.lock();
        let part = |name: &str, text: &Option<Arc<str>>| format!("\"{name}\":{}", text.as_deref().unwrap_or("null"));
        format!(
            "{{{},{},{},{}}}",
            part("hello", &documents.hello),
            part("estimate", &documents.whole_estimate()),
            part("link", &documents.link),
            part("end", &documents.end)
        )
    }

    fn lock(&self) -> MutexGuard<'_, Documents> {
        // No code panics while it holds the lock; if it did, the documents would still be whole.
        self.documents.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Audience for Hub {
    fn hear(&mut self, kind: DocumentKind, document: &str) {
        self.publish(kind, document);
    }
}

impl Documents {
    /// The newest estimate with the readiness that is valid for it.
    fn whole_estimate(&self) -> Option<Arc<str>> {
        let (number, estimate) = self.estimate.as_ref()?;
        let Some((_, readiness)) = self.readiness.as_ref().filter(|(renewed, _)| renewed != number) else {
            return Some(Arc::clone(estimate));
        };
        let (Ok(mut whole), Ok(readiness)) =
            (serde_json::from_str::<Value>(estimate), serde_json::from_str::<Value>(readiness))
        else {
            return Some(Arc::clone(estimate));
        };
        let parameters = whole.get_mut("parameters").and_then(Value::as_array_mut).into_iter().flatten();
        let renewed = readiness.get("parameters").and_then(Value::as_array).into_iter().flatten();
        for (parameter, renewed) in parameters.zip(renewed) {
            if let (Some(parameter), Some(readiness)) = (parameter.as_object_mut(), renewed.get("readiness")) {
                parameter.insert("readiness".to_owned(), readiness.clone());
            }
        }
        Some(whole.to_string().into())
    }

    fn add(&mut self, kind: DocumentKind, document: Arc<str>) {
        match kind {
            DocumentKind::Hello => {
                // Another flight has begun; estimates of the one before do not belong to it.
                (self.past, self.stride, self.since) = (Vec::new(), 1, 0);
                (self.estimate, self.readiness) = (None, None);
                self.hello = Some(Arc::clone(&document));
            }
            DocumentKind::Estimate { readiness, .. } => {
                let numbered = (self.next, Arc::clone(&document));
                self.since += 1;
                if self.since >= self.stride {
                    self.since = 0;
                    self.past.push(numbered.clone());
                }
                if self.past.len() > PAST {
                    let mut keep = false;
                    self.past.retain(|_| {
                        keep = !keep;
                        keep
                    });
                    self.stride *= 2;
                }
                if readiness {
                    self.readiness = Some(numbered.clone());
                }
                self.estimate = Some(numbered);
            }
            DocumentKind::Event => {
                self.events.push_back(Arc::clone(&document));
                if self.events.len() > EVENTS {
                    self.events.pop_front();
                }
            }
            DocumentKind::Link => self.link = Some(Arc::clone(&document)),
            DocumentKind::End => self.end = Some(Arc::clone(&document)),
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
        hub.publish(DocumentKind::Hello, "hello");
        for k in 0..360_000 {
            hub.publish(DocumentKind::Estimate { shown: true, readiness: false }, &k.to_string());
            hub.publish(DocumentKind::Estimate { shown: false, readiness: true }, "not for pages");
        }
        let (past, _) = hub.new_client();
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
        let (_, mut place) = hub.new_client();
        (0..10).for_each(|k| hub.publish(DocumentKind::Event, &k.to_string()));
        let (news, lost) = hub.since(&mut place);
        assert_eq!((news.len(), lost), (10, 0));
        (10..2010).for_each(|k| hub.publish(DocumentKind::Event, &k.to_string()));
        let (news, lost) = hub.since(&mut place);
        assert_eq!((news.iter().map(|text| &**text).collect::<Vec<_>>(), lost), (vec!["2009"], 1999));
        assert_eq!(hub.since(&mut place), (vec![], 0));
    }

    /// Estimates without readiness, after one that had it: a new client, a slow client and `result.json` get it
    /// nevertheless.
    #[test]
    fn readiness_is_not_lost() {
        let hub = Hub::default();
        hub.publish(DocumentKind::Hello, "{}");
        let (_, mut place) = hub.new_client();
        let estimate = |time_s: u32, readiness: bool| {
            let field = if readiness { r#","readiness":{"verdict":"ready"}"# } else { "" };
            let text = format!(r#"{{"time_s":{time_s},"parameters":[{{"value":{time_s}.5{field}}}]}}"#);
            hub.publish(DocumentKind::Estimate { shown: true, readiness }, &text);
        };
        (0..2000).for_each(|k| estimate(k, k % 100 == 50));
        let (past, _) = hub.new_client();
        let last_renewed = past.iter().rposition(|text| text.contains("readiness")).unwrap();
        assert!(past[last_renewed].contains(r#""time_s":1950,"#) && past.len() - last_renewed > 1, "{last_renewed}");
        let times: Vec<u64> =
            past.iter().filter_map(|text| serde_json::from_str::<Value>(text).ok()?["time_s"].as_u64()).collect();
        assert!(times.is_sorted_by(|a, b| a < b));
        let (news, lost) = hub.since(&mut place);
        assert!(lost > 0 && news.len() == 2 && news[0].contains(r#""time_s":1950,"#), "{news:?}");
        let whole: Value = serde_json::from_str(&hub.snapshot()).unwrap();
        let parameter = &whole["estimate"]["parameters"][0];
        assert_eq!((&parameter["value"], &parameter["readiness"]["verdict"]), (&1999.5.into(), &"ready".into()));
    }
}
