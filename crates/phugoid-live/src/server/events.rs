//! Server-sent events (<https://html.spec.whatwg.org/multipage/server-sent-events.html>).

use std::convert::Infallible;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use hyper::body::{Body, Bytes, Frame};
use tokio::sync::mpsc;

use super::hub::Hub;

/// Events that wait for a client's connection; what is beyond it waits in the hub, and is passed over there.
const WAITING: usize = 16;
/// A connection that takes nothing for this long is given up.
const STUCK: Duration = Duration::from_secs(30);
/// How often a silent connection hears that it is still there.
const ALIVE: Duration = Duration::from_secs(15);

/// The body of an answer that does not end.
pub(super) struct Events {
    frames: mpsc::Receiver<Bytes>,
}

impl Events {
    pub(super) fn new(hub: Hub) -> Self {
        let (sender, frames) = mpsc::channel(WAITING);
        tokio::spawn(async move {
            // None: the client has gone, or is stuck.
            let _: Option<()> = pump(&hub, &sender).await;
        });
        Self { frames }
    }
}

async fn pump(hub: &Hub, client: &mpsc::Sender<Bytes>) -> Option<()> {
    let send =
        |text: String| async move { tokio::time::timeout(STUCK, client.send(Bytes::from(text))).await.ok()?.ok() };
    let mut changes = hub.watch();
    let (past, mut place) = hub.newcomer();
    for document in past {
        send(format!("data: {document}\n\n")).await?;
    }
    loop {
        let (news, lost) = hub.since(&mut place);
        if lost > 0 {
            send(format!(": {lost} documents passed over\n\n")).await?;
        }
        for document in news {
            send(format!("data: {document}\n\n")).await?;
        }
        match tokio::time::timeout(ALIVE, changes.changed()).await {
            Ok(changed) => changed.ok()?,
            Err(_) => send(": alive\n\n".to_owned()).await?,
        }
    }
}

impl Body for Events {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        self.frames.poll_recv(context).map(|bytes| bytes.map(|bytes| Ok(Frame::data(bytes))))
    }
}
