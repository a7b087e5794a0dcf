//! What a log has defined so far: the layouts of messages, and which topic is logged under which number.

use std::rc::Rc;

use super::format::{Formats, Layout};
use crate::log::decode::Place;
use crate::log::sink::Stream;

/// What was defined so far.
#[derive(Debug, Default)]
pub(super) struct Definitions {
    pub(super) formats: Formats,
    /// By the number under which a topic is logged.
    pub(super) topics: Vec<Option<Box<Subscription>>>,
}

impl Definitions {
    /// Least and greatest size of a sample of this number.
    #[inline]
    pub(super) fn sizes(&self, id: u16) -> Option<(usize, usize)> {
        let topic = self.topics.get(usize::from(id))?.as_ref()?;
        Some((topic.layout.least, topic.layout.most))
    }
}

/// A topic under its number.
#[derive(Debug)]
pub(super) struct Subscription {
    pub(super) name: String,
    pub(super) instance: u16,
    pub(super) layout: Rc<Layout>,
    pub(super) state: State,
    /// The clock of a satellite receiver, where the topic has one.
    pub(super) utc: Option<Place>,
}

#[derive(Debug)]
pub(super) enum State {
    /// No sample yet.
    Announced,
    /// Nothing of it is wanted, or it has no time.
    Unwanted,
    Open {
        stream: Stream,
        places: Vec<Place>,
    },
}
