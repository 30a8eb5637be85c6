//! Writes small bags: MCAP without compression, CDR of both byte orders.

use std::collections::BTreeMap;
use std::io::Cursor;

const COMMON: &str = "==========\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
                      ==========\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n\
                      ==========\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n\
                      ==========\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n\
                      ==========\nMSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";
const OWN_ODOMETRY: &str = "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
                            ==========\nMSG: geometry_msgs/PoseWithCovariance\nPose pose\n\
                            ==========\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n";
const OWN_PEOPLE: &str = "std_msgs/Header header\npeople_msgs/Person[] people\n\
                          ==========\nMSG: people_msgs/Person\nstring name\ngeometry_msgs/Point position\n";
const OWN_TRANSFORMS: &str = "geometry_msgs/TransformStamped[] transforms\n\
                              ==========\nMSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n\
                              Transform transform\n==========\nMSG: geometry_msgs/Transform\nVector3 translation\n\
                              Quaternion rotation\n";

/// Bytes of a message.
struct Cdr {
    bytes: Vec<u8>,
    big_endian: bool,
}

impl Cdr {
    fn new(big_endian: bool) -> Self {
        Self { bytes: vec![0, u8::from(!big_endian), 0, 0], big_endian }
    }

    fn put<const N: usize>(&mut self, little: [u8; N]) {
        while !(self.bytes.len() - 4).is_multiple_of(N) {
            self.bytes.push(0);
        }
        let mut bytes = little;
        if self.big_endian {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
    }

    fn text(&mut self, text: &str) {
        self.put(u32::try_from(text.len() + 1).unwrap().to_le_bytes());
        self.bytes.extend(text.bytes().chain([0]));
    }

    fn floats(&mut self, values: &[f64]) {
        values.iter().for_each(|value| self.put(value.to_le_bytes()));
    }

    fn header(&mut self, at: i64, frame: &str) {
        self.put(i32::try_from(at.div_euclid(1_000_000_000)).unwrap().to_le_bytes());
        self.put(u32::try_from(at.rem_euclid(1_000_000_000)).unwrap().to_le_bytes());
        self.text(frame);
    }
}

/// A bag that is written.
pub(super) struct Pen {
    writer: ::mcap::Writer<Cursor<Vec<u8>>>,
    channels: BTreeMap<(String, String), u16>,
    pub(super) big_endian: bool,
}

impl Pen {
    pub(super) fn new() -> Self {
        let options = ::mcap::WriteOptions::new().compression(None).profile("ros2").use_chunks(false);
        let options = options.calculate_data_section_crc(false).calculate_summary_section_crc(false);
        let writer = options.create(Cursor::new(Vec::new())).unwrap();
        Self { writer, channels: BTreeMap::new(), big_endian: false }
    }

    pub(super) fn raw(&mut self, topic: &str, kind: &str, encoding: &str, definition: &str, at: i64, data: &[u8]) {
        let writer = &mut self.writer;
        let channel = *self.channels.entry((topic.to_owned(), definition.to_owned())).or_insert_with(|| {
            let schema = writer.add_schema(kind, "ros2msg", definition.as_bytes()).unwrap();
            writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap()
        });
        let log_time = u64::try_from(at).unwrap();
        let header =
            ::mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time, publish_time: log_time };
        self.writer.write_to_known_channel(&header, data).unwrap();
    }

    fn send(&mut self, topic: &str, kind: &str, definition: &str, at: i64, cdr: Cdr) {
        self.raw(topic, kind, "cdr", definition, at, &cdr.bytes);
    }

    pub(super) fn odometry_bytes(&self, at: i64, frame: &str, [x, y]: [f64; 2]) -> Vec<u8> {
        let mut cdr = Cdr::new(self.big_endian);
        cdr.header(at, frame);
        cdr.text("base_link");
        cdr.floats(&[x, y, 0.0, 0.0, 0.0, 0.0, 1.0]);
        cdr.bytes
    }

    pub(super) fn odometry(&mut self, topic: &str, at: i64, frame: &str, place: [f64; 2]) {
        let bytes = self.odometry_bytes(at, frame, place);
        self.raw(topic, "nav_msgs/msg/Odometry", "cdr", &odometry(), at, &bytes);
    }

    pub(super) fn people(&mut self, topic: &str, at: i64, frame: &str, people: &[(&str, [f64; 2])]) {
        let mut cdr = Cdr::new(self.big_endian);
        cdr.header(at, frame);
        cdr.put(u32::try_from(people.len()).unwrap().to_le_bytes());
        for (name, [x, y]) in people {
            cdr.text(name);
            cdr.floats(&[*x, *y, 0.0]);
        }
        self.send(topic, "people_msgs/msg/People", &format!("{OWN_PEOPLE}{COMMON}"), at, cdr);
    }

    pub(super) fn transform(&mut self, topic: &str, at: i64, parent: &str, child: &str, [x, y]: [f64; 2]) {
        let mut cdr = Cdr::new(self.big_endian);
        cdr.put(1_u32.to_le_bytes());
        cdr.header(at, parent);
        cdr.text(child);
        cdr.floats(&[x, y, 0.0, 0.0, 0.0, 0.0, 1.0]);
        self.send(topic, "tf2_msgs/msg/TFMessage", &format!("{OWN_TRANSFORMS}{COMMON}"), at, cdr);
    }

    pub(super) fn bytes(mut self) -> Vec<u8> {
        self.writer.finish().unwrap();
        self.writer.into_inner().into_inner()
    }
}

/// The definition that [`Pen::odometry`] writes: only what is needed of the real one.
pub(super) fn odometry() -> String {
    format!("{OWN_ODOMETRY}{COMMON}")
}
