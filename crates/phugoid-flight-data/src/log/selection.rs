//! Which part of a log is kept.

/// Which topics and fields are kept; all others are read past.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    /// What to keep; everything if there is no list.
    pub topics: Option<Vec<Wanted>>,
    /// Bound on memory: values and times kept, 8 bytes each (default 100 million, 0.8 GB).
    pub max_values: usize,
}

/// One topic to keep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The log's name of it.
    pub topic: String,
    /// Which instance; all if not given.
    pub instance: Option<u16>,
    /// Names of fields; all if not given.
    pub fields: Option<Vec<String>>,
}

impl Default for Selection {
    fn default() -> Self {
        Self { topics: None, max_values: 100_000_000 }
    }
}

impl Selection {
    /// These topics with all their instances and fields.
    pub fn topics<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let wanted = |name: &str| Wanted { topic: name.to_owned(), instance: None, fields: None };
        Self { topics: Some(names.into_iter().map(wanted).collect()), ..Self::default() }
    }

    /// Is anything of this topic kept?
    pub fn has_topic(&self, topic: &str, instance: u16) -> bool {
        self.entries(topic, instance).is_none_or(|mut entries| entries.next().is_some())
    }

    /// Is this field of a topic kept?
    pub fn has_field(&self, topic: &str, instance: u16, field: &str) -> bool {
        let named =
            |wanted: &Wanted| wanted.fields.as_ref().is_none_or(|fields| fields.iter().any(|name| name == field));
        self.entries(topic, instance).is_none_or(|mut entries| entries.any(named))
    }

    /// The entries about a topic; none where everything is kept.
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
