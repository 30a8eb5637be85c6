//! The map editor as a process, and what its page asks of it.

use std::path::Path;
use std::process::Child;

use serde_json::Value;

use crate::console::ask;
use crate::program::{poll, signal, start};

/// A running editor; it ends with the test.
#[derive(Debug)]
pub struct Editor {
    child: Child,
    /// Address of its page, with the token.
    pub page: String,
    /// Where it listens, such as `127.0.0.1:40123`.
    pub address: String,
    token: String,
}

impl Editor {
    /// Starts one on a free port, with these arguments behind `map edit`.
    ///
    /// # Errors
    /// When the process cannot be started, or does not say where it is.
    pub fn start(program: &str, folder: &Path, name: &str, args: &[&str]) -> std::io::Result<Self> {
        let args = [&["--format", "json", "map", "edit"], args].concat();
        let child = start(program, &args, folder, name)?;
        let told = poll(|| {
            let text = std::fs::read_to_string(folder.join(format!("{name}.out"))).ok()?;
            serde_json::from_str::<Value>(text.lines().next()?).ok()
        });
        let told = told.ok_or_else(|| std::io::Error::other("the editor does not say where it is"))?;
        let text = |key: &str| told.get(key).and_then(Value::as_str).unwrap_or_default().to_owned();
        let page = text("page");
        let address = page.trim_start_matches("http://").split('/').next().unwrap_or_default().to_owned();
        Ok(Self { child, address, token: text("token"), page })
    }

    /// Its process.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Status and body of the answer to a request of its page.
    ///
    /// # Errors
    /// When nobody answers.
    pub fn ask(&self, line: &str, body: &Value) -> std::io::Result<(u16, Value)> {
        let body = if body.is_null() { String::new() } else { body.to_string() };
        ask(&self.address, line, &format!("authorization: Bearer {}\r\n", self.token), &body)
    }

    /// Ends it with a signal, and waits.
    ///
    /// # Errors
    /// When it cannot be told or waited for.
    pub fn end(mut self, how: &str) -> std::io::Result<()> {
        signal(self.child.id(), how)?;
        self.child.wait().map(drop)
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}
