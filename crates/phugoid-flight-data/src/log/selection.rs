//! Selects the part of a log that is kept in memory.

use crate::memory::Memory;

/// Which topics and fields of a log are kept. The default keeps everything.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// What is kept; everything if `None`.
    pub topics: Option<Vec<Wanted>>,
    /// The most memory that reading may take (default 200 MB), see [`crate::memory`].
    pub max_memory: Memory,
}

/// A topic that is to be kept, whole or in part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Name of the topic in the log.
    pub topic: String,
    /// Number of the instance; all instances if `None`.
    pub instance: Option<u16>,
    /// Names of the fields; all fields if `None`.
    pub fields: Option<Vec<String>>,
}

impl Selection {
    /// Selects these topics with all their instances and fields.
    pub fn topics<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let wanted = |name: &str| Wanted { topic: name.to_owned(), instance: None, fields: None };
        Self { topics: Some(names.into_iter().map(wanted).collect()), ..Self::default() }
    }

    /// True if anything of this topic is kept.
    pub fn has_topic(&self, topic: &str, instance: u16) -> bool {
        self.entries(topic, instance).is_none_or(|mut entries| entries.next().is_some())
    }

    /// True if this field of the topic is kept.
    pub fn has_field(&self, topic: &str, instance: u16, field: &str) -> bool {
        let named =
            |wanted: &Wanted| wanted.fields.as_ref().is_none_or(|fields| fields.iter().any(|name| name == field));
        self.entries(topic, instance).is_none_or(|mut entries| entries.any(named))
    }

    /// The entries about a topic; `None` if everything is kept.
    fn entries<'a>(&'a self, topic: &'a str, instance: u16) -> Option<impl Iterator<Item = &'a Wanted>> {
        let same = move |wanted: &&Wanted| wanted.topic == topic && wanted.instance.is_none_or(|one| one == instance);
        Some(self.topics.as_ref()?.iter().filter(same))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_a_topic_an_instance_or_a_field() {
        assert!(Selection::default().has_field("IMU", 3, "GyrX"));
        let selection = Selection::topics(["IMU", "ATT"]);
        assert!(selection.has_field("IMU", 1, "GyrX") && !selection.has_topic("BARO", 0));
        let wanted = Wanted { topic: "IMU".into(), instance: Some(0), fields: Some(vec!["GyrX".into()]) };
        let selection = Selection { topics: Some(vec![wanted]), ..Selection::default() };
        assert!(selection.has_topic("IMU", 0) && !selection.has_topic("IMU", 1));
        assert!(selection.has_field("IMU", 0, "GyrX") && !selection.has_field("IMU", 0, "GyrY"));
    }
}
