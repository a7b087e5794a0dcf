//! Converts Arrow arrays to `f64`, with NaN for missing values.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Date32Type, DurationMicrosecondType, DurationMillisecondType, DurationNanosecondType, DurationSecondType,
    Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, Time32MillisecondType,
    Time32SecondType, Time64MicrosecondType, Time64NanosecondType, TimestampMicrosecondType, TimestampMillisecondType,
    TimestampNanosecondType, TimestampSecondType, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrowPrimitiveType};
use arrow_schema::{DataType, TimeUnit};

/// The kind of the values of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Numbers, whose unit is in the name or the metadata.
    Number,
    /// Points in time, which become seconds from 1970 or from midnight.
    Time,
    /// Durations, which are converted to seconds.
    Duration,
}

impl Kind {
    /// The unit of the values after [`append`], if the type determines it.
    pub(super) fn unit(self) -> Option<&'static str> {
        (self != Kind::Number).then_some("s")
    }

    pub(super) fn is_time(self) -> bool {
        self == Kind::Time
    }
}

/// The kind of the values of this type. The error says what they are instead of numbers.
pub(super) fn kind(data_type: &DataType) -> Result<Kind, String> {
    use DataType::{
        Binary, BinaryView, Boolean, Date32, Dictionary, Duration, FixedSizeBinary, FixedSizeList, Float16, Float32,
        Float64, Int8, Int16, Int32, Int64, LargeBinary, LargeList, LargeUtf8, List, ListView, Map, Null, Struct,
        Time32, Time64, Timestamp, UInt8, UInt16, UInt32, UInt64, Union, Utf8, Utf8View,
    };
    match data_type {
        Boolean | Int8 | Int16 | Int32 | Int64 | UInt8 | UInt16 | UInt32 | UInt64 | Float16 | Float32 | Float64 => {
            Ok(Kind::Number)
        }
        Timestamp(..) | Time32(_) | Time64(_) | Date32 => Ok(Kind::Time),
        Duration(_) => Ok(Kind::Duration),
        Utf8 | LargeUtf8 | Utf8View => Err("text".into()),
        Dictionary(..) => {
            Err("a dictionary (categories); write its values as plain numbers if they are a signal".into())
        }
        List(_) | LargeList(_) | ListView(_) | FixedSizeList(..) | Struct(_) | Map(..) | Union(..) => {
            Err("nested; write each of its elements as a column of its own if they are signals".into())
        }
        Binary | LargeBinary | BinaryView | FixedSizeBinary(_) => Err("bytes".into()),
        Null => Err("empty".into()),
        other => Err(format!("of the type {other}; write it as float64 if it is a signal")),
    }
}

/// Appends the values of an array; nothing if its type is not one that [`kind`] accepts.
pub(super) fn append(array: &dyn Array, values: &mut Vec<f64>) {
    use DataType::{
        Boolean, Date32, Duration, Float16, Float32, Float64, Int8, Int16, Int32, Int64, Time32, Time64, Timestamp,
        UInt8, UInt16, UInt32, UInt64,
    };
    use TimeUnit::{Microsecond, Millisecond, Nanosecond, Second};
    match array.data_type() {
        Float64 => all::<Float64Type>(array, values, |value| value),
        Float32 => all::<Float32Type>(array, values, f64::from),
        Float16 => all::<Float16Type>(array, values, f64::from),
        Int8 => all::<Int8Type>(array, values, f64::from),
        Int16 => all::<Int16Type>(array, values, f64::from),
        Int32 => all::<Int32Type>(array, values, f64::from),
        Int64 => all::<Int64Type>(array, values, |value| value as f64),
        UInt8 => all::<UInt8Type>(array, values, f64::from),
        UInt16 => all::<UInt16Type>(array, values, f64::from),
        UInt32 => all::<UInt32Type>(array, values, f64::from),
        UInt64 => all::<UInt64Type>(array, values, |value| value as f64),
        Boolean => {
            if let Some(array) = array.as_boolean_opt() {
                values.extend(array.iter().map(|value| value.map_or(f64::NAN, |value| f64::from(u8::from(value)))));
            }
        }
        Timestamp(Second, _) => all::<TimestampSecondType>(array, values, |value| seconds(value, 1)),
        Timestamp(Millisecond, _) => all::<TimestampMillisecondType>(array, values, |value| seconds(value, 1_000)),
        Timestamp(Microsecond, _) => all::<TimestampMicrosecondType>(array, values, |value| seconds(value, 1_000_000)),
        Timestamp(Nanosecond, _) => {
            all::<TimestampNanosecondType>(array, values, |value| seconds(value, 1_000_000_000));
        }
        Duration(Second) => all::<DurationSecondType>(array, values, |value| seconds(value, 1)),
        Duration(Millisecond) => all::<DurationMillisecondType>(array, values, |value| seconds(value, 1_000)),
        Duration(Microsecond) => all::<DurationMicrosecondType>(array, values, |value| seconds(value, 1_000_000)),
        Duration(Nanosecond) => all::<DurationNanosecondType>(array, values, |value| seconds(value, 1_000_000_000)),
        Time32(Second) => all::<Time32SecondType>(array, values, |value| seconds(i64::from(value), 1)),
        Time32(Millisecond) => all::<Time32MillisecondType>(array, values, |value| seconds(i64::from(value), 1_000)),
        Time64(Microsecond) => all::<Time64MicrosecondType>(array, values, |value| seconds(value, 1_000_000)),
        Time64(Nanosecond) => all::<Time64NanosecondType>(array, values, |value| seconds(value, 1_000_000_000)),
        Date32 => all::<Date32Type>(array, values, |days| f64::from(days) * 86_400.0),
        _ => {}
    }
}

fn all<T: ArrowPrimitiveType>(array: &dyn Array, values: &mut Vec<f64>, number: impl Fn(T::Native) -> f64) {
    if let Some(array) = array.as_primitive_opt::<T>() {
        values.extend(array.iter().map(|value| value.map_or(f64::NAN, &number)));
    }
}

/// Converts to seconds. Whole seconds and the remainder are converted apart, because nanoseconds since 1970 have more
/// digits than a double.
fn seconds(value: i64, per_second: i64) -> f64 {
    value.div_euclid(per_second) as f64 + value.rem_euclid(per_second) as f64 / per_second as f64
}

#[cfg(test)]
mod tests {
    use super::seconds;

    #[test]
    fn seconds_are_as_exact_as_a_double_can_be() {
        assert_eq!(seconds(1_714_566_896_250_000_000, 1_000_000_000), 1_714_566_896.25);
        assert_eq!(seconds(-250, 1000), -0.25);
        assert_eq!(seconds(i64::MIN, 1), i64::MIN as f64);
        // A product with 1e-9 would give ...0002384.
        assert_eq!(seconds(1_714_566_896_100_000_000, 1_000_000_000), 1_714_566_896.1);
    }
}
