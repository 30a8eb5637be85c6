//! The author console as a process, and what its page and programs ask of it.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::Child;

use serde_json::{Value, json};

use crate::program::{poll, start};

/// A running console; it ends with the test.
pub struct Console {
    child: Child,
    /// What it printed: `page`, `base`, `run`, `record`, `token`.
    pub told: Value,
    /// Where it listens, such as `127.0.0.1:40123`.
    pub address: String,
}

impl Console {
    /// Starts one on a free port.
    ///
    /// # Errors
    /// When the process cannot be started, or does not say where it is.
    pub fn start(program: &str, folder: &Path) -> std::io::Result<Self> {
        let child = start(program, &["--format", "json", "author", "console"], folder, "console")?;
        let told = poll(|| {
            let text = std::fs::read_to_string(folder.join("console.out")).ok()?;
            serde_json::from_str::<Value>(text.lines().next()?).ok()
        });
        let told = told.ok_or_else(|| std::io::Error::other("the console does not say where it is"))?;
        let base = told.get("base").and_then(Value::as_str).unwrap_or_default();
        let address = base.trim_start_matches("http://").trim_end_matches("/v1").to_owned();
        Ok(Self { child, told, address })
    }

    /// Status and body of the answer to a request of its page.
    ///
    /// # Errors
    /// When nobody answers.
    pub fn page(&self, line: &str, body: &Value) -> std::io::Result<(u16, Value)> {
        let token = self.told.get("token").and_then(Value::as_str).unwrap_or_default();
        let body = if body.is_null() { String::new() } else { body.to_string() };
        ask(&self.address, line, &format!("authorization: Bearer {token}\r\n"), &body)
    }

    /// Numbers and forms of the questions that wait.
    ///
    /// # Errors
    /// As [`Console::page`].
    pub fn waiting(&self) -> std::io::Result<Vec<(u64, String)>> {
        let (_, list) = self.page("GET /questions", &Value::Null)?;
        let all = list.get("questions").and_then(Value::as_array).cloned().unwrap_or_default();
        let waits = all.iter().filter(|one| one.get("state").and_then(Value::as_str) == Some("waits"));
        let one = |one: &Value| Some((one.get("number")?.as_u64()?, one.get("form")?.as_str()?.to_owned()));
        Ok(waits.filter_map(one).collect())
    }

    /// Answers a question; gives the status and what was said to it.
    ///
    /// # Errors
    /// As [`Console::page`].
    pub fn answer(&self, number: u64, text: &str) -> std::io::Result<(u16, Value)> {
        self.page(&format!("POST /questions/{number}/answer"), &json!({ "text": text }))
    }

    /// Asks it to leave, and waits.
    ///
    /// # Errors
    /// When it cannot be told or waited for.
    pub fn leave(mut self) -> std::io::Result<()> {
        crate::program::signal(self.child.id(), "INT")?;
        self.child.wait().map(drop)
    }
}

impl Drop for Console {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

/// Status and body of the answer to a request with further lines of its head. A body that is no JSON is told as text.
///
/// # Errors
/// When nobody answers.
pub fn ask(address: &str, line: &str, head: &str, body: &str) -> std::io::Result<(u16, Value)> {
    let mut stream = TcpStream::connect(address)?;
    let length = body.len();
    let text = format!(
        "{line} HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\ncontent-length: {length}\r\n{head}\r\n{body}"
    );
    stream.write_all(text.as_bytes())?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer)?;
    let (head, body) = answer.split_once("\r\n\r\n").unwrap_or((&answer, ""));
    let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
    Ok((status, serde_json::from_str(body).unwrap_or_else(|_text| json!(body))))
}
