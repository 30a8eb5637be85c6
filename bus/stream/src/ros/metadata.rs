//! `metadata.yaml` of a bag's folder: which files it has, in order.

use serde::Deserialize;

use super::fault::BagFault;

/// Most files of a bag.
const MOST_FILES: usize = 10_000;

#[derive(Debug, Deserialize)]
struct Whole {
    rosbag2_bagfile_information: Information,
}

#[derive(Debug, Deserialize)]
struct Information {
    storage_identifier: String,
    relative_file_paths: Vec<String>,
    #[serde(default)]
    compression_format: Option<String>,
    #[serde(default)]
    compression_mode: Option<String>,
}

/// Files of a bag by the text of its `metadata.yaml`, relative to its folder, in order.
///
/// # Errors
/// [`BagFault::Metadata`] for what is no such text, names no file or one outside the folder; [`BagFault::Storage`] and
/// [`BagFault::Compressed`] for bags that are not read.
pub fn files(text: &str) -> Result<Vec<String>, BagFault> {
    let bad = |why: String| BagFault::Metadata { why };
    let whole: Whole = yaml_serde::from_str(text).map_err(|why| bad(why.to_string()))?;
    let Information { storage_identifier, relative_file_paths: files, compression_format, compression_mode } =
        whole.rosbag2_bagfile_information;
    if storage_identifier != "mcap" {
        return Err(BagFault::Storage { storage: storage_identifier });
    }
    let mode = compression_mode.unwrap_or_default();
    if !mode.is_empty() && !mode.eq_ignore_ascii_case("none") {
        return Err(BagFault::Compressed { mode, format: compression_format.unwrap_or_default() });
    }
    if files.is_empty() {
        return Err(bad("`relative_file_paths` names no file".to_owned()));
    }
    if files.len() > MOST_FILES {
        return Err(bad(format!("`relative_file_paths` names {} files; at most {MOST_FILES} are read", files.len())));
    }
    let leaves = |file: &&String| file.is_empty() || file.starts_with('/') || file.split('/').any(|part| part == "..");
    if let Some(file) = files.iter().find(leaves) {
        return Err(bad(format!("`relative_file_paths` names `{file}`, which is not in the folder")));
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(lines: &str) -> Result<Vec<String>, BagFault> {
        files(&format!("rosbag2_bagfile_information:\n  version: 9\n  message_count: 3\n{lines}"))
    }

    #[test]
    fn files_are_named_in_order_and_other_keys_are_passed_over() {
        let files = of(
            "  storage_identifier: mcap\n  relative_file_paths:\n  - a_0.mcap\n  - a_1.mcap\n  compression_mode: ''\n",
        );
        assert_eq!(files.unwrap(), ["a_0.mcap", "a_1.mcap"]);
    }

    #[test]
    fn what_is_not_read_is_told_with_a_way_out() {
        let mcap = "  storage_identifier: mcap\n  relative_file_paths: ";
        for (lines, word, hint) in [
            (
                "  storage_identifier: sqlite3\n  relative_file_paths: [a.db3]\n".to_owned(),
                "`sqlite3`",
                "ros2 bag convert",
            ),
            (
                format!("{mcap}[a.mcap.zstd]\n  compression_mode: FILE\n  compression_format: zstd\n"),
                "`FILE`",
                "rosbags-convert",
            ),
            (format!("{mcap}[]\n"), "names no file", "reindex"),
            (format!("{mcap}[../a.mcap]\n"), "`../a.mcap`", "reindex"),
            (format!("{mcap}[/dev/zero]\n"), "`/dev/zero`", "reindex"),
            ("  relative_file_paths: [a.mcap]\n".to_owned(), "storage_identifier", "reindex"),
            ("- ]".to_owned(), "no metadata", "reindex"),
        ] {
            let why = of(&lines).unwrap_err();
            assert!(why.to_string().contains(word) && why.hint().contains(hint), "{why}: {}", why.hint());
        }
    }
}
