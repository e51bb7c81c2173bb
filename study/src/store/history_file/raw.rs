//! Writes through the C interface of HDF5: file images and fixed-length null-terminated text, which the
//! safe binding does not offer, and attributes and columns with fewer calls than the safe binding
//! needs. A history file has over a hundred attributes, so their calls take most of its time.
//!
//! A dimension scale is a dataset with the attributes `CLASS` and `NAME` (fixed-length,
//! null-terminated text) and `REFERENCE_LIST`. A dataset along the scale has the attribute
//! `DIMENSION_LIST`. Source: "HDF5 Dimension Scale Specification and Design Notes". The high-level
//! library that writes them is not linked, so this module writes them.
#![expect(unsafe_code, reason = "calls into libhdf5; no other module of the crate makes them")]

use std::ffi::{CString, c_void};

use hdf5::dataset::DatasetCreate;
use hdf5::datatype::Datatype;
use hdf5::types::{VarLenArray, VarLenUnicode};
use hdf5::{Dataset, Dataspace, File, Group, H5Type, Location, ObjectReference, ObjectReference1};
use hdf5_sys::h5::herr_t;
use hdf5_sys::h5a::{H5Aclose, H5Acreate2, H5Awrite};
use hdf5_sys::h5d::{H5Dcreate2, H5Dwrite};
use hdf5_sys::h5f::H5Fget_file_image;
use hdf5_sys::h5i::hid_t;
use hdf5_sys::h5p::H5P_DEFAULT;
use hdf5_sys::h5s::{H5S_ALL, H5S_seloper_t, H5Sselect_hyperslab};
use hdf5_sys::h5t::{H5T_C_S1, H5Tclose, H5Tcopy, H5Tset_size, hvl_t};

/// Writes attributes: holds the type and the space that they share.
pub struct Writer {
    text: Datatype,
    scalar: Dataspace,
}

impl Writer {
    /// Creates the type and the space.
    pub fn new() -> hdf5::Result<Self> {
        Ok(Self { text: Datatype::from_type::<VarLenUnicode>()?, scalar: Dataspace::try_new(())? })
    }

    /// Writes text of any length, UTF-8.
    pub fn text(&self, location: &Location, name: &str, text: &str) -> hdf5::Result<()> {
        let text = CString::new(text).map_err(|error| error.to_string())?;
        let pointer = text.as_ptr();
        // SAFETY: `self.text` is "pointer to null-terminated text", and `pointer` is one.
        unsafe {
            attribute(location, name, self.text.id(), &self.scalar, (&raw const pointer).cast())
        }
    }

    /// Writes fixed-length text with its terminating null. The specification of dimension scales
    /// allows no other text.
    fn fixed_text(&self, location: &Location, name: &str, text: &str) -> hdf5::Result<()> {
        let text = CString::new(text).map_err(|error| error.to_string())?;
        let bytes = text.as_bytes_with_nul();
        hdf5::sync::sync(|| {
            // SAFETY: `text_type` is a new copy, closed below, and as long as `bytes`.
            unsafe {
                let text_type = H5Tcopy(*H5T_C_S1);
                check(H5Tset_size(text_type, bytes.len()), "set the length of a text")?;
                let value = bytes.as_ptr().cast();
                let written = attribute(location, name, text_type, &self.scalar, value);
                H5Tclose(text_type);
                written
            }
        })
    }

    /// Makes datasets dimension scales and attaches them: `along` gives, for each axis of a dataset, the
    /// number of its scale. The names are relative to `group`.
    pub fn attach(
        &self,
        group: &Group,
        scales: &[(&str, &Dataset)],
        datasets: &[Scaled<'_>],
    ) -> hdf5::Result<()> {
        let axes_type = Datatype::from_type::<VarLenArray<ObjectReference1>>()?;
        let mut references = Vec::with_capacity(scales.len());
        for (name, scale) in scales {
            self.fixed_text(scale, "CLASS", "DIMENSION_SCALE")?;
            self.fixed_text(scale, "NAME", name)?;
            references.push(ObjectReference1::create(group, name)?);
        }
        let mut attached: Vec<Vec<Attached>> = vec![Vec::new(); scales.len()];
        for Scaled { name, dataset, along } in datasets.iter().filter(|one| !one.along.is_empty()) {
            let axes: Vec<hvl_t> = along
                .iter()
                .map(|scale| hvl_t { len: 1, p: (&raw const references[*scale]).cast_mut().cast() })
                .collect();
            let space = Dataspace::try_new([axes.len()])?;
            // SAFETY: `axes_type` is "length and pointer to references", and `axes` has one such value for
            // each axis; the references live as long as the call.
            unsafe {
                let value = axes.as_ptr().cast();
                attribute(dataset, "DIMENSION_LIST", axes_type.id(), &space, value)?;
            }
            let dataset = ObjectReference1::create(group, name)?;
            for (dimension, scale) in (0..).zip(*along) {
                attached[*scale].push(Attached { dataset, dimension });
            }
        }
        for ((_, scale), attached) in scales.iter().zip(&attached) {
            if !attached.is_empty() {
                scale.new_attr_builder().with_data(attached).create("REFERENCE_LIST")?;
            }
        }
        Ok(())
    }
}

/// A dataset, and the number of the dimension scale of each of its axes.
pub struct Scaled<'a> {
    /// Name, relative to the group.
    pub name: &'a str,
    /// The dataset.
    pub dataset: &'a Dataset,
    /// Number of the scale of each axis.
    pub along: &'a [usize],
}

/// One entry of `REFERENCE_LIST`.
#[derive(Debug, Clone, Copy, H5Type)]
#[repr(C)]
struct Attached {
    dataset: ObjectReference1,
    dimension: i32,
}

/// Creates columns of equal length.
pub struct Columns {
    number: Datatype,
    space: Dataspace,
    create: DatasetCreate,
    samples: usize,
}

impl Columns {
    /// Columns of `samples` values, stored with these creation properties.
    pub fn new(samples: usize, create: DatasetCreate) -> hdf5::Result<Self> {
        Ok(Self {
            number: Datatype::from_type::<f64>()?,
            space: Dataspace::try_new([samples])?,
            create,
            samples,
        })
    }

    /// Creates and writes a column.
    pub fn write(&self, group: &Group, name: &str, values: &[f64]) -> hdf5::Result<Dataset> {
        if values.len() != self.samples {
            return Err(format!("{name} has {} of {} samples", values.len(), self.samples).into());
        }
        let name = CString::new(name).map_err(|error| error.to_string())?;
        hdf5::sync::sync(|| {
            // SAFETY: every id is open; `owner` closes the new one; `values` is as long as the
            // space.
            unsafe {
                let dataset = H5Dcreate2(
                    group.id(),
                    name.as_ptr(),
                    self.number.id(),
                    self.space.id(),
                    H5P_DEFAULT,
                    self.create.id(),
                    H5P_DEFAULT,
                );
                let owner: Dataset = hdf5::from_id(dataset)?;
                let values = values.as_ptr().cast();
                let number = self.number.id();
                check(
                    H5Dwrite(dataset, number, H5S_ALL, H5S_ALL, H5P_DEFAULT, values),
                    "write a column",
                )?;
                Ok(owner)
            }
        })
    }
}

/// Writes numbers into a block of a dataset: `start` and `count` have one number for each axis.
pub fn write_block(
    dataset: &Dataset,
    start: &[u64],
    count: &[u64],
    values: &[f64],
) -> hdf5::Result<()> {
    let size: u64 = count.iter().product();
    if start.len() != dataset.ndim()
        || start.len() != count.len()
        || u64::try_from(values.len()).ok() != Some(size)
    {
        return Err("a block of another shape than its dataset or its values".into());
    }
    let number = Datatype::from_type::<f64>()?;
    let (space, memory) = (dataset.space()?, Dataspace::try_new([values.len()])?);
    hdf5::sync::sync(|| {
        // SAFETY: every id is open; `start` and `count` are as long as the rank of the dataset; `values` has
        // as many numbers as the block.
        unsafe {
            let set = H5S_seloper_t::H5S_SELECT_SET;
            let (start, count) = (start.as_ptr(), count.as_ptr());
            let none = std::ptr::null();
            check(
                H5Sselect_hyperslab(space.id(), set, start, none, count, none),
                "choose a block",
            )?;
            let values = values.as_ptr().cast();
            check(
                H5Dwrite(dataset.id(), number.id(), memory.id(), space.id(), H5P_DEFAULT, values),
                "write a block",
            )
        }
    })
}

fn check(status: herr_t, what: &str) -> hdf5::Result<()> {
    if status < 0 { Err(format!("HDF5 cannot {what}").into()) } else { Ok(()) }
}

/// Creates and writes an attribute.
///
/// # Safety
/// `value` must point to data of type `value_type` with the shape of `space`.
unsafe fn attribute(
    location: &Location,
    name: &str,
    value_type: hid_t,
    space: &Dataspace,
    value: *const c_void,
) -> hdf5::Result<()> {
    let name = CString::new(name).map_err(|error| error.to_string())?;
    hdf5::sync::sync(|| {
        // SAFETY: every id is open; the new one is closed here; the caller guarantees `value`.
        unsafe {
            let (location, space) = (location.id(), space.id());
            let new =
                H5Acreate2(location, name.as_ptr(), value_type, space, H5P_DEFAULT, H5P_DEFAULT);
            if new < 0 {
                return Err(format!("HDF5 cannot create the attribute {name:?}").into());
            }
            let written = H5Awrite(new, value_type, value);
            H5Aclose(new);
            check(written, "write an attribute")
        }
    })
}

/// The bytes of a file held in memory.
pub fn image(file: &File) -> hdf5::Result<Vec<u8>> {
    file.flush()?;
    hdf5::sync::sync(|| {
        // SAFETY: without a buffer, HDF5 returns the size; the buffer then has that size.
        unsafe {
            let size = H5Fget_file_image(file.id(), std::ptr::null_mut(), 0);
            let mut bytes = vec![0_u8; usize::try_from(size).unwrap_or(0)];
            let copied = H5Fget_file_image(file.id(), bytes.as_mut_ptr().cast(), bytes.len());
            if size <= 0 || copied != size {
                return Err("cannot take the image of a file in memory".into());
            }
            Ok(bytes)
        }
    })
}
