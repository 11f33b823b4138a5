//! Bytes of a saved state: little-endian numbers, one after the other.

use crate::{Soa3, Soa3Ref, Vec3};

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
    /// A part of the scene cannot tell its state.
    #[error("{what} cannot tell its state, so that the scene cannot be saved: implement its `save` and `restore`")]
    CannotSave {
        /// Which part.
        what: String,
    },
}

/// Writes a state.
///
/// ```
/// use lbm_ibm_coupling::{StateReader, StateWriter, Vec3};
///
/// let mut to = StateWriter::default();
/// to.numbers(&[1.0, f64::INFINITY]);
/// to.vector(Vec3::new(0.1, 0.2, 0.3));
/// let bytes = to.into_bytes();
/// let (mut from, mut numbers) = (StateReader::new(&bytes, "an example"), [0.0; 2]);
/// from.numbers(&mut numbers)?;
/// assert_eq!((numbers, from.vector()?), ([1.0, f64::INFINITY], Vec3::new(0.1, 0.2, 0.3)));
/// from.end()?;
/// # Ok::<(), lbm_ibm_coupling::StateError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct StateWriter(Vec<u8>);

impl StateWriter {
    /// A whole number.
    pub fn count(&mut self, number: u64) {
        self.bytes(&number.to_le_bytes());
    }

    /// A number, bit by bit.
    pub fn number(&mut self, number: f64) {
        self.bytes(&number.to_le_bytes());
    }

    /// Numbers; whoever reads them knows how many.
    pub fn numbers(&mut self, numbers: &[f64]) {
        self.0.reserve(8 * numbers.len());
        numbers.iter().for_each(|n| self.number(*n));
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
        self.bytes(bytes);
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    /// What has been written.
    pub fn into_bytes(self) -> Vec<u8> {
        self.0
    }
}

/// Reads a state in the order in which it was written.
///
/// Its methods return [`StateError::Length`] where the bytes end early.
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

    fn take(&mut self, bytes: usize) -> Result<&'a [u8], StateError> {
        let Some((first, rest)) = self.rest.split_at_checked(bytes) else {
            return Err(StateError::Length {
                what: self.what.clone(),
                bytes: bytes - self.rest.len(),
                short: true,
            });
        };
        self.rest = rest;
        Ok(first)
    }

    fn eight(&mut self) -> Result<[u8; 8], StateError> {
        let mut eight = [0; 8];
        eight.copy_from_slice(self.take(8)?);
        Ok(eight)
    }

    /// A whole number.
    ///
    /// # Errors
    /// [`StateError::Length`].
    pub fn count(&mut self) -> Result<u64, StateError> {
        self.eight().map(u64::from_le_bytes)
    }

    /// A number.
    ///
    /// # Errors
    /// [`StateError::Length`].
    pub fn number(&mut self) -> Result<f64, StateError> {
        self.eight().map(f64::from_le_bytes)
    }

    /// Fills `numbers`.
    ///
    /// # Errors
    /// [`StateError::Length`].
    pub fn numbers(&mut self, numbers: &mut [f64]) -> Result<(), StateError> {
        numbers.iter_mut().try_for_each(|n| self.number().map(|read| *n = read))
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
    /// [`StateError::Length`].
    pub fn part(&mut self) -> Result<&'a [u8], StateError> {
        let bytes = self.count()?;
        self.take(usize::try_from(bytes).unwrap_or(usize::MAX))
    }

    /// A whole number that has to be `here`.
    ///
    /// # Errors
    /// [`StateError::Length`], [`StateError::Differs`] with `what` it is.
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

/// Checksum of bytes: FNV-1a of 64 bits, by words of eight bytes, then by bytes. Each word is mixed from above too, for a
/// product carries no bit downwards.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let mix = |hash: u64, word: u64| {
        let hash = (hash ^ word).wrapping_mul(0x0100_0000_01b3);
        hash ^ (hash >> 32)
    };
    let (words, rest) = bytes.as_chunks::<8>();
    let hash = words
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, w| mix(hash, u64::from_le_bytes(*w)));
    rest.iter().fold(hash, |hash, b| mix(hash, u64::from(*b)))
}
