//! The definitions of a log so far: the layouts of messages, and the topics with the numbers of their messages.

use std::rc::Rc;

use super::format::{Formats, Layout};
use crate::log::decode::Place;
use crate::log::sink::Stream;

/// The definitions read so far.
#[derive(Debug, Default)]
pub(super) struct Definitions {
    pub(super) formats: Formats,
    /// The topics, indexed by the number that their messages carry.
    pub(super) topics: Vec<Option<Box<Subscription>>>,
}

impl Definitions {
    /// Smallest and largest size of a sample with this number, bytes; `None` if the number is not known.
    #[inline]
    pub(super) fn sizes(&self, id: u16) -> Option<(usize, usize)> {
        let topic = self.topics.get(usize::from(id))?.as_ref()?;
        Some((topic.layout.least, topic.layout.most))
    }
}

/// A topic that the log has announced under a number.
#[derive(Debug)]
pub(super) struct Subscription {
    pub(super) name: String,
    pub(super) instance: u16,
    pub(super) layout: Rc<Layout>,
    pub(super) state: State,
    /// The field with the UTC of a satellite receiver, if the topic has one.
    pub(super) utc: Option<Place>,
}

/// What is done with the samples of a topic.
#[derive(Debug)]
pub(super) enum State {
    /// No sample has come yet.
    Announced,
    /// They are not selected, or have no time.
    Unwanted,
    /// They go to the sink.
    Open { stream: Stream, places: Vec<Place> },
}
