//! The content of the records that are needed, taken from their bytes without a copy (mcap.dev, "MCAP Format
//! Specification", "Records"). The library allocates the lengths that are written there; here they are only compared
//! with the bytes that there are.

/// Takes what a record holds from its bytes, one after the other; `None` where they end too early.
pub(super) struct Content<'a>(pub(super) &'a [u8]);

/// A channel: its numbers, topic and encoding.
pub(super) struct Channel<'a> {
    pub(super) id: u16,
    pub(super) schema: u16,
    pub(super) topic: &'a str,
    pub(super) encoding: &'a str,
}

/// A message: its channel, its time and what it says.
pub(super) struct Message<'a> {
    pub(super) channel: u16,
    /// Time at which it was recorded, ns.
    pub(super) log_time: u64,
    pub(super) data: &'a [u8],
}

/// A chunk: its sizes, and the records in it as they are packed.
pub(super) struct Chunk<'a> {
    pub(super) unpacked: u64,
    pub(super) compression: &'a str,
    pub(super) records: &'a [u8],
}

impl<'a> Content<'a> {
    fn take(&mut self, count: u64) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(usize::try_from(count).ok()?)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn text(&mut self) -> Option<&'a str> {
        let length = u32::from_le_bytes(self.array()?);
        std::str::from_utf8(self.take(u64::from(length))?).ok()
    }

    /// Profile and library of a header.
    pub(super) fn header(mut self) -> Option<[(&'static str, &'a str); 2]> {
        Some([("profile", self.text()?), ("library", self.text()?)])
    }

    /// Number and name of a schema.
    pub(super) fn schema(mut self) -> Option<(u16, &'a str)> {
        Some((u16::from_le_bytes(self.array()?), self.text()?))
    }

    pub(super) fn channel(mut self) -> Option<Channel<'a>> {
        let (id, schema) = (u16::from_le_bytes(self.array()?), u16::from_le_bytes(self.array()?));
        Some(Channel { id, schema, topic: self.text()?, encoding: self.text()? })
    }

    pub(super) fn message(mut self) -> Option<Message<'a>> {
        let channel = u16::from_le_bytes(self.array()?);
        let _sequence: [u8; 4] = self.array()?;
        let log_time = u64::from_le_bytes(self.array()?);
        let _publish_time: [u8; 8] = self.array()?;
        Some(Message { channel, log_time, data: self.0 })
    }

    pub(super) fn chunk(mut self) -> Option<Chunk<'a>> {
        let _times: [u8; 16] = self.array()?;
        let unpacked = u64::from_le_bytes(self.array()?);
        let _check_sum: [u8; 4] = self.array()?;
        let compression = self.text()?;
        let packed = u64::from_le_bytes(self.array()?);
        Some(Chunk { unpacked, compression, records: self.take(packed)? })
    }
}
