//! Reception from a serial line.

use std::io;
use std::path::Path;

/// Opens a serial line with eight data bits, no parity and no translation of bytes.
#[cfg(unix)]
pub(super) fn open(device: &Path, baud: u32) -> io::Result<std::fs::File> {
    use std::os::unix::fs::OpenOptionsExt;

    use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
    use rustix::termios::{ControlModes, OptionalActions, SpecialCodeIndex, tcgetattr, tcsetattr};

    let failed = |what: &str, error: rustix::io::Errno| {
        io::Error::new(io::Error::from(error).kind(), format!("{}: {what}: {error}", device.display()))
    };
    // A blocking open would wait for the carrier, because CLOCAL is not set yet.
    let flags = (OFlags::NOCTTY | OFlags::NONBLOCK).bits();
    let file = std::fs::OpenOptions::new().read(true).write(true).custom_flags(flags as i32).open(device)?;
    let mut line = tcgetattr(&file).map_err(|error| failed("is no serial line", error))?;
    line.make_raw();
    line.control_modes |= ControlModes::CLOCAL | ControlModes::CREAD;
    line.set_speed(baud).map_err(|error| failed(&format!("cannot run at {baud} bits per second"), error))?;
    // A read returns with at least one byte, so that silence on the line is not taken for its end.
    line.special_codes[SpecialCodeIndex::VMIN] = 1;
    line.special_codes[SpecialCodeIndex::VTIME] = 0;
    tcsetattr(&file, OptionalActions::Now, &line).map_err(|error| failed("cannot be set up", error))?;
    let blocking = fcntl_getfl(&file).map_err(|error| failed("cannot be set up", error))? - OFlags::NONBLOCK;
    fcntl_setfl(&file, blocking).map_err(|error| failed("cannot be set up", error))?;
    Ok(file)
}

/// Serial lines are not supported on this system; the error says what to do instead.
#[cfg(not(unix))]
pub(super) fn open(device: &Path, _baud: u32) -> io::Result<std::fs::File> {
    Err(io::Error::new(
        io::ErrorKind::Unsupported,
        format!(
            "{}: serial lines are read on Linux and macOS only. Let another program pass it on, such as \
             mavproxy.py --master=COM3 --out=udp:127.0.0.1:14550, and receive from udp://14550",
            device.display()
        ),
    ))
}
