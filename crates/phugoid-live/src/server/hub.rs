//! What clients get: a bounded past for newcomers, and the newest for everybody.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard};

use serde_json::Value;
use tokio::sync::watch;

use crate::audience::Audience;
use crate::document::Kind;

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
    recent: VecDeque<Numbered>,
    hello: Option<Arc<str>>,
    link: Option<Arc<str>>,
    end: Option<Arc<str>>,
    events: VecDeque<Arc<str>>,
    past: Vec<Numbered>,
    /// Every how many estimates one is kept for the past, and how many came since the last.
    stride: usize,
    since: usize,
    estimate: Option<Numbered>,
    /// The newest estimate that has the readiness of the parameters: it stands for those after it.
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
    /// Takes a document.
    pub fn publish(&self, kind: Kind, document: &str) {
        if !kind.is_shown() {
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
        let mut estimates: Vec<Numbered> = documents.past.clone();
        estimates.extend(documents.readiness.iter().chain(&documents.estimate).cloned());
        estimates.sort_by_key(|(number, _)| *number);
        estimates.dedup_by_key(|(number, _)| *number);
        let before = documents.hello.iter().chain(&documents.events).cloned();
        let after = documents.link.iter().chain(&documents.end).cloned();
        let all = before.chain(estimates.into_iter().map(|(_, estimate)| estimate)).chain(after);
        (all.collect(), documents.next)
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
        let readiness = documents.readiness.iter().filter(|(number, _)| (*place..from).contains(number));
        let news = readiness.chain(documents.recent.iter().filter(|(number, _)| *number >= from));
        let news = news.map(|(_, text)| Arc::clone(text)).collect();
        *place = documents.next;
        (news, lost)
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
            part("estimate", &documents.whole_estimate()),
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
    /// The newest estimate, with the readiness of the parameters that stands.
    fn whole_estimate(&self) -> Option<Arc<str>> {
        let (number, estimate) = self.estimate.as_ref()?;
        let Some((_, readiness)) = self.readiness.as_ref().filter(|(told, _)| told != number) else {
            return Some(Arc::clone(estimate));
        };
        let (Ok(mut whole), Ok(readiness)) =
            (serde_json::from_str::<Value>(estimate), serde_json::from_str::<Value>(readiness))
        else {
            return Some(Arc::clone(estimate));
        };
        let parameters = whole.get_mut("parameters").and_then(Value::as_array_mut).into_iter().flatten();
        let told = readiness.get("parameters").and_then(Value::as_array).into_iter().flatten();
        for (parameter, told) in parameters.zip(told) {
            if let (Some(parameter), Some(readiness)) = (parameter.as_object_mut(), told.get("readiness")) {
                parameter.insert("readiness".to_owned(), readiness.clone());
            }
        }
        Some(whole.to_string().into())
    }

    fn add(&mut self, kind: Kind, document: Arc<str>) {
        match kind {
            Kind::Hello => {
                // Another flight: its estimates have nothing to do with those before.
                (self.past, self.stride, self.since) = (Vec::new(), 1, 0);
                (self.estimate, self.readiness) = (None, None);
                self.hello = Some(Arc::clone(&document));
            }
            Kind::Estimate { readiness, .. } => {
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
            hub.publish(Kind::Estimate { shown: true, readiness: false }, &k.to_string());
            hub.publish(Kind::Estimate { shown: false, readiness: true }, "not for pages");
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

    /// Estimates whose readiness was told before: a newcomer, a slow client and `result.json` have it all the same.
    #[test]
    fn readiness_is_not_lost() {
        let hub = Hub::default();
        hub.publish(Kind::Hello, "{}");
        let (_, mut place) = hub.newcomer();
        let estimate = |time_s: u32, readiness: bool| {
            let told = if readiness { r#","readiness":{"verdict":"ready"}"# } else { "" };
            let text = format!(r#"{{"time_s":{time_s},"parameters":[{{"value":{time_s}.5{told}}}]}}"#);
            hub.publish(Kind::Estimate { shown: true, readiness }, &text);
        };
        (0..2000).for_each(|k| estimate(k, k % 100 == 50));
        let (past, _) = hub.newcomer();
        let last_told = past.iter().rposition(|text| text.contains("readiness")).unwrap();
        assert!(past[last_told].contains(r#""time_s":1950,"#) && past.len() - last_told > 1, "{last_told}");
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
