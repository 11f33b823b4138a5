//! Bytes of a saved state: what is written to it, one after the other, in the format of postcard.

use crate::{Soa3, Soa3Ref, Vec3};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Serialize, Serializer};
use twox_hash::XxHash64;

/// Why a saved state cannot be made or taken.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// The bytes are no saved scene.
    #[error("these {bytes} bytes are no saved scene: give the file that `Scene::save` was written to")]
    NotAScene {
        /// Bytes given.
        bytes: usize,
    },
    /// Another version of the format.
    #[error(
        "the saved scene has format {found}, this program reads {known}: use the version of the crate that saved it"
    )]
    Version {
        /// Format of the bytes.
        found: u64,
        /// Format that is known.
        known: u64,
    },
    /// The bytes have changed since they were saved.
    #[error(
        "the saved scene of {bytes} bytes is damaged: its checksum is {found:016x}, it was {expected:016x}; use another save"
    )]
    Damaged {
        /// Bytes given.
        bytes: usize,
        /// Checksum of the bytes.
        found: u64,
        /// Checksum that they carry.
        expected: u64,
    },
    /// The scene is not built as the saved one was.
    #[error("{what}: {saved} in the saved scene, {here} in this one; build the scene as the saved one was built")]
    Differs {
        /// What differs.
        what: String,
        /// In the saved scene.
        saved: String,
        /// In the scene that is to take it.
        here: String,
    },
    /// A part of the state has another length than the part of the scene that takes it.
    #[error("{what}: its saved state has {bytes} bytes too {}; build the scene as the saved one was built", if *short { "few" } else { "many" })]
    Length {
        /// Which part.
        what: String,
        /// How many.
        bytes: usize,
        /// Whether they are missing; else they are left.
        short: bool,
    },
    /// A part of the state is not what the part of the scene that takes it wrote.
    #[error(
        "{what}: its saved state cannot be read {bytes} bytes before its end: {why}; build the scene as the saved one was built"
    )]
    Unreadable {
        /// Which part.
        what: String,
        /// Bytes from where it fails to the end.
        bytes: usize,
        /// Why not.
        why: String,
    },
    /// A value has no place in the format.
    #[error("a value of the state cannot be written: {why}; give sequences and maps their length")]
    Unwritable {
        /// Why not.
        why: String,
    },
    /// A part of the scene cannot tell its state.
    #[error("{what} cannot tell its state, so that the scene cannot be saved: implement its `save` and `restore`")]
    CannotSave {
        /// Which part.
        what: String,
    },
}

/// Writes a state, in the format of postcard.
///
/// ```
/// use lbm_ibm_coupling::{StateReader, StateWriter, Vec3};
///
/// let mut to = StateWriter::default();
/// to.numbers(&[1.0, f64::INFINITY]);
/// to.vector(Vec3::new(0.1, 0.2, 0.3));
/// to.put(&Some("anything that serde knows"));
/// let bytes = to.into_bytes()?;
/// let (mut from, mut numbers) = (StateReader::new(&bytes, "an example"), [0.0; 2]);
/// from.numbers(&mut numbers)?;
/// assert_eq!((numbers, from.vector()?), ([1.0, f64::INFINITY], Vec3::new(0.1, 0.2, 0.3)));
/// assert_eq!(from.get::<Option<String>>()?.as_deref(), Some("anything that serde knows"));
/// from.end()?;
/// # Ok::<(), lbm_ibm_coupling::StateError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct StateWriter {
    bytes: Vec<u8>,
    /// Why the first value that could not be written was not.
    failed: Option<String>,
}

impl StateWriter {
    /// A value of any type that serde can serialise.
    pub fn put<T: Serialize + ?Sized>(&mut self, value: &T) {
        if self.failed.is_some() {
            return;
        }
        match postcard::to_extend(value, std::mem::take(&mut self.bytes)) {
            Ok(bytes) => self.bytes = bytes,
            Err(error) => self.failed = Some(error.to_string()),
        }
    }

    /// A whole number.
    pub fn count(&mut self, number: u64) {
        self.put(&number);
    }

    /// A number, bit by bit.
    pub fn number(&mut self, number: f64) {
        self.put(&number);
    }

    /// Numbers; whoever reads them knows how many.
    pub fn numbers(&mut self, numbers: &[f64]) {
        self.put(&Tuple(numbers));
    }

    /// A vector.
    pub fn vector(&mut self, vector: Vec3) {
        self.numbers(vector.as_slice());
    }

    /// An array of vectors; whoever reads it knows its length.
    pub fn array(&mut self, array: Soa3Ref<'_>) {
        [array.x, array.y, array.z].iter().for_each(|a| self.numbers(a));
    }

    /// Bytes, and how many.
    pub fn part(&mut self, bytes: &[u8]) {
        self.count(bytes.len() as u64);
        self.bytes.extend_from_slice(bytes);
    }

    /// What has been written.
    ///
    /// # Errors
    /// [`StateError::Unwritable`] if a value could not be.
    pub fn into_bytes(self) -> Result<Vec<u8>, StateError> {
        match self.failed {
            None => Ok(self.bytes),
            Some(why) => Err(StateError::Unwritable { why }),
        }
    }
}

/// Numbers of which the reader knows how many.
struct Tuple<'a>(&'a [f64]);

impl Serialize for Tuple<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|n| tuple.serialize_element(n))?;
        tuple.end()
    }
}

/// Reads a state in the order in which it was written.
///
/// Its methods return [`StateError::Unreadable`] or [`StateError::Length`] where the bytes are not what is asked for.
#[derive(Clone, Debug)]
pub struct StateReader<'a> {
    rest: &'a [u8],
    what: String,
}

impl<'a> StateReader<'a> {
    /// Reads `bytes`, which are the state of `what`.
    pub fn new(bytes: &'a [u8], what: impl Into<String>) -> Self {
        Self {
            rest: bytes,
            what: what.into(),
        }
    }

    /// A value of [`StateWriter::put`].
    ///
    /// # Errors
    /// [`StateError::Unreadable`].
    pub fn get<T: Deserialize<'a>>(&mut self) -> Result<T, StateError> {
        let (value, rest) = postcard::take_from_bytes(self.rest).map_err(|error| StateError::Unreadable {
            what: self.what.clone(),
            bytes: self.rest.len(),
            why: error.to_string(),
        })?;
        self.rest = rest;
        Ok(value)
    }

    /// That as many bytes are there.
    fn has(&self, bytes: usize) -> Result<(), StateError> {
        match bytes.checked_sub(self.rest.len()) {
            None | Some(0) => Ok(()),
            Some(bytes) => Err(StateError::Length {
                what: self.what.clone(),
                bytes,
                short: true,
            }),
        }
    }

    /// A whole number.
    ///
    /// # Errors
    /// [`StateError::Unreadable`].
    pub fn count(&mut self) -> Result<u64, StateError> {
        self.get()
    }

    /// A number.
    ///
    /// # Errors
    /// [`StateError::Unreadable`].
    pub fn number(&mut self) -> Result<f64, StateError> {
        self.get()
    }

    /// Fills `numbers`.
    ///
    /// # Errors
    /// [`StateError::Length`].
    pub fn numbers(&mut self, numbers: &mut [f64]) -> Result<(), StateError> {
        self.has(8 * numbers.len())?;
        numbers.iter_mut().try_for_each(|n| self.get().map(|read| *n = read))
    }

    /// A vector.
    ///
    /// # Errors
    /// [`StateError::Length`].
    pub fn vector(&mut self) -> Result<Vec3, StateError> {
        let mut vector = Vec3::zeros();
        self.numbers(vector.as_mut_slice())?;
        Ok(vector)
    }

    /// Fills an array of vectors.
    ///
    /// # Errors
    /// [`StateError::Length`].
    pub fn array(&mut self, array: &mut Soa3) -> Result<(), StateError> {
        let Soa3 { x, y, z } = array;
        [x, y, z].into_iter().try_for_each(|a| self.numbers(a))
    }

    /// Bytes of [`StateWriter::part`].
    ///
    /// # Errors
    /// [`StateError::Unreadable`], [`StateError::Length`].
    pub fn part(&mut self) -> Result<&'a [u8], StateError> {
        let bytes = usize::try_from(self.count()?).unwrap_or(usize::MAX);
        self.has(bytes)?;
        let (first, rest) = self.rest.split_at(bytes);
        self.rest = rest;
        Ok(first)
    }

    /// A whole number that has to be `here`.
    ///
    /// # Errors
    /// [`StateError::Unreadable`], [`StateError::Differs`] with `what` it is.
    pub fn same(&mut self, what: impl Into<String>, here: u64) -> Result<(), StateError> {
        let saved = self.count()?;
        differs(what, saved.to_string(), here.to_string())
    }

    /// That nothing is left.
    ///
    /// # Errors
    /// [`StateError::Length`].
    pub fn end(&self) -> Result<(), StateError> {
        match self.rest.len() {
            0 => Ok(()),
            bytes => Err(StateError::Length {
                what: self.what.clone(),
                bytes,
                short: false,
            }),
        }
    }
}

/// An error where the two are not the same.
pub(crate) fn differs(what: impl Into<String>, saved: String, here: String) -> Result<(), StateError> {
    if saved == here {
        return Ok(());
    }
    Err(StateError::Differs {
        what: what.into(),
        saved,
        here,
    })
}

/// Checksum of bytes: XXH64.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    XxHash64::oneshot(0, bytes)
}
