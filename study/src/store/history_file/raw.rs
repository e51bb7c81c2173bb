//! Writing through bare HDF5 calls: what the safe binding has no call for (file images, text that
//! is fixed-length and null-terminated), and what it takes thirty calls for where three do. A
//! history file has over a hundred attributes, and their calls were most of its cost.
//!
//! A dimension scale is a dataset with the attributes `CLASS` and `NAME` (fixed-length,
//! null-terminated text) and `REFERENCE_LIST`; a dataset along it carries `DIMENSION_LIST` ("HDF5
//! Dimension Scale Specification and Design Notes"). The high-level library that writes them is not
//! linked, so they are written by hand here.
#![expect(unsafe_code, reason = "calls into libhdf5; the one room that makes them")]

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
use hdf5_sys::h5s::H5S_ALL;
use hdf5_sys::h5t::{H5T_C_S1, H5Tclose, H5Tcopy, H5Tset_size, hvl_t};

/// Types and spaces every attribute of a file shares.
pub struct Writer {
    text: Datatype,
    scalar: Dataspace,
}

impl Writer {
    /// Prepares them.
    pub fn new() -> hdf5::Result<Self> {
        Ok(Self { text: Datatype::from_type::<VarLenUnicode>()?, scalar: Dataspace::try_new(())? })
    }

    /// Writes text of any length, UTF-8.
    pub fn text(&self, location: &Location, name: &str, text: &str) -> hdf5::Result<()> {
        let text = CString::new(text).map_err(|error| error.to_string())?;
        let pointer = text.as_ptr();
        // SAFETY: the type says "pointer to null-terminated text", and `pointer` is one.
        unsafe {
            attribute(location, name, self.text.id(), &self.scalar, (&raw const pointer).cast())
        }
    }

    /// Writes text of fixed length with its terminating null: the only kind the specification
    /// takes for a dimension scale.
    fn fixed_text(&self, location: &Location, name: &str, text: &str) -> hdf5::Result<()> {
        let text = CString::new(text).map_err(|error| error.to_string())?;
        let bytes = text.as_bytes_with_nul();
        hdf5::sync::sync(|| {
            // SAFETY: the type is a fresh copy, closed below; it is as long as `bytes`.
            unsafe {
                let kind = H5Tcopy(*H5T_C_S1);
                check(H5Tset_size(kind, bytes.len()), "size a text")?;
                let written = attribute(location, name, kind, &self.scalar, bytes.as_ptr().cast());
                H5Tclose(kind);
                written
            }
        })
    }

    /// Makes `scale` the dimension scale of the first axis of `datasets`. Both are named relative
    /// to `group`.
    pub fn attach(
        &self,
        group: &Group,
        (name, scale): (&str, &Dataset),
        datasets: &[(&str, Dataset)],
    ) -> hdf5::Result<()> {
        self.fixed_text(scale, "CLASS", "DIMENSION_SCALE")?;
        self.fixed_text(scale, "NAME", name)?;
        let axes_type = Datatype::from_type::<VarLenArray<ObjectReference1>>()?;
        let one = Dataspace::try_new([1])?;
        let mut reference = ObjectReference1::create(group, name)?;
        let axes = hvl_t { len: 1, p: (&raw mut reference).cast() };
        let mut attached = Vec::with_capacity(datasets.len());
        for (name, dataset) in datasets {
            // SAFETY: the type says "pointer to references", and `axes` holds one such of one.
            unsafe {
                let value = (&raw const axes).cast();
                attribute(dataset, "DIMENSION_LIST", axes_type.id(), &one, value)?;
            }
            let dataset = ObjectReference1::create(group, name)?;
            attached.push(Attached { dataset, dimension: 0 });
        }
        scale.new_attr_builder().with_data(&attached).create("REFERENCE_LIST")?;
        Ok(())
    }
}

/// One entry of `REFERENCE_LIST`.
#[derive(Debug, Clone, Copy, H5Type)]
#[repr(C)]
struct Attached {
    dataset: ObjectReference1,
    dimension: i32,
}

/// Creates columns of one length.
pub struct Columns {
    kind: Datatype,
    space: Dataspace,
    create: DatasetCreate,
    samples: usize,
}

impl Columns {
    /// Of that many samples, stored as `create` says.
    pub fn new(samples: usize, create: DatasetCreate) -> hdf5::Result<Self> {
        Ok(Self {
            kind: Datatype::from_type::<f64>()?,
            space: Dataspace::try_new([samples])?,
            create,
            samples,
        })
    }

    /// Creates a column and writes it.
    pub fn write(&self, group: &Group, name: &str, values: &[f64]) -> hdf5::Result<Dataset> {
        if values.len() != self.samples {
            return Err(format!("{name} has {} of {} samples", values.len(), self.samples).into());
        }
        let name = CString::new(name).map_err(|error| error.to_string())?;
        hdf5::sync::sync(|| {
            // SAFETY: every id is alive; the new one is handed to an owner at once; `values` is
            // as long as the space says.
            unsafe {
                let dataset = H5Dcreate2(
                    group.id(),
                    name.as_ptr(),
                    self.kind.id(),
                    self.space.id(),
                    H5P_DEFAULT,
                    self.create.id(),
                    H5P_DEFAULT,
                );
                let owner: Dataset = hdf5::from_id(dataset)?;
                let values = values.as_ptr().cast();
                let kind = self.kind.id();
                check(
                    H5Dwrite(dataset, kind, H5S_ALL, H5S_ALL, H5P_DEFAULT, values),
                    "write a column",
                )?;
                Ok(owner)
            }
        })
    }
}

fn check(status: herr_t, what: &str) -> hdf5::Result<()> {
    if status < 0 { Err(format!("HDF5 cannot {what}").into()) } else { Ok(()) }
}

/// Creates an attribute and writes it.
///
/// # Safety
/// `value` must point to what `kind` and `space` say.
unsafe fn attribute(
    location: &Location,
    name: &str,
    kind: hid_t,
    space: &Dataspace,
    value: *const c_void,
) -> hdf5::Result<()> {
    let name = CString::new(name).map_err(|error| error.to_string())?;
    hdf5::sync::sync(|| {
        // SAFETY: every id is alive; the new one is closed here; the rest is the caller's promise.
        unsafe {
            let (location, space) = (location.id(), space.id());
            let new = H5Acreate2(location, name.as_ptr(), kind, space, H5P_DEFAULT, H5P_DEFAULT);
            if new < 0 {
                return Err(format!("HDF5 cannot create the attribute {name:?}").into());
            }
            let written = H5Awrite(new, kind, value);
            H5Aclose(new);
            check(written, "write an attribute")
        }
    })
}

/// The bytes of a file held in memory.
pub fn image(file: &File) -> hdf5::Result<Vec<u8>> {
    file.flush()?;
    hdf5::sync::sync(|| {
        // SAFETY: asked with no buffer HDF5 gives the size; the buffer then has that size.
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
