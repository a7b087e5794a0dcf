//! The damage that was measured in the wind tunnel.

/// Damage of the Generic Transport Model, in the order of the cases of its data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Damage {
    /// The whole aircraft.
    #[default]
    None,
    /// Case 1: both halves of the rudder are gone.
    RudderOff,
    /// Case 2: the vertical tail is gone, and the rudder with it.
    VerticalTailOff,
    /// Case 3: the left outboard flap is gone.
    LeftOutboardFlapOff,
    /// Case 4: the outer quarter of the left wing is gone, and the left aileron with it.
    LeftWingTipOff,
    /// Case 5: the left elevator is gone.
    LeftElevatorOff,
    /// Case 6: the left half of the stabiliser is gone, and the left elevator with it.
    LeftStabiliserOff,
}

/// Word of a configuration and its name in the tables.
const NAMES: [(&str, &str); 7] = [
    ("none", ""),
    ("rudder-off", "Rudder Off"),
    ("vertical-tail-off", "Vertical Tail Off"),
    ("left-outboard-flap-off", "Left Outboard Flap Off"),
    ("left-wing-tip-off", "Left Wingtip(25%) Off"),
    ("left-elevator-off", "Left Elevator Off"),
    ("left-stabiliser-off", "Left Stabilizer Off"),
];

impl Damage {
    /// No damage, then the six cases in the order of the data.
    pub const ALL: [Self; 7] = [
        Self::None,
        Self::RudderOff,
        Self::VerticalTailOff,
        Self::LeftOutboardFlapOff,
        Self::LeftWingTipOff,
        Self::LeftElevatorOff,
        Self::LeftStabiliserOff,
    ];

    /// Number of the case in the data, 1 to 6; 0 for no damage.
    pub fn case(self) -> usize {
        self as usize
    }

    /// The word for files and command lines: `none`, `rudder-off`, `vertical-tail-off`, `left-outboard-flap-off`,
    /// `left-wing-tip-off`, `left-elevator-off` or `left-stabiliser-off`.
    pub fn word(self) -> &'static str {
        NAMES[self as usize].0
    }

    /// The damage of a [`word`](Self::word); `None` for any other word.
    ///
    /// ```
    /// use phugoid_aircraft::transport::Damage;
    ///
    /// assert_eq!(Damage::from_word("left-stabiliser-off"), Some(Damage::LeftStabiliserOff));
    /// assert_eq!(Damage::from_word("right-wing-off"), None);
    /// assert!(Damage::ALL.iter().all(|damage| Damage::from_word(damage.word()) == Some(*damage)));
    /// ```
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|damage| damage.word() == word)
    }

    /// The name that the axis of damage cases in the tables gives it.
    pub(super) fn name_in_tables(self) -> &'static str {
        NAMES[self as usize].1
    }
}

impl std::fmt::Display for Damage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.word())
    }
}
