use std::path::PathBuf;

use super::parse::{ControlGroups, address_space_limit, group_folders, kibibytes};
use super::*;

const MEMINFO: &str =
    "MemTotal:       24684364 kB\nMemFree:        12345 kB\nMemAvailable:   23912345 kB\n";
const LIMITS: &str = "Limit                     Soft Limit           Hard Limit           Units     \n\
                      Max resident set          unlimited            unlimited            bytes     \n\
                      Max address space         716800000            unlimited            bytes     \n";

#[test]
fn the_smallest_of_machine_group_and_address_space_decides() {
    let files = |limits: &str, groups: Vec<Group>| SystemFiles {
        meminfo: MEMINFO.to_owned(),
        limits: limits.to_owned(),
        status: "Name:\tbillow\nVmSize:\t   70000 kB\nVmHWM:\t 60000 kB\n".to_owned(),
        groups,
    };
    let kind = |files: SystemFiles| smallest(&limits_of(&files), 1).unwrap();
    let machine = kind(files("", Vec::new()));
    assert_eq!(machine.kind, LimitKind::Machine);
    assert_eq!(machine.free, 23_912_345 << 10);
    assert_eq!(machine.to_string(), "the machine's memory of 25 GB");
    let address = kind(files(LIMITS, Vec::new()));
    assert_eq!(address.free, 716_800_000 - (70_000 << 10));
    assert_eq!(address.to_string(), "the address space limit of 717 MB (ulimit -v)");
    let group = Group { limit: 300_000_000, used: 10_000_000 };
    let group = kind(files(LIMITS, vec![Group { limit: 1 << 40, used: 0 }, group]));
    assert_eq!(group.to_string(), "the control group's limit of 300 MB (cgroup)");
    assert_eq!(group.free, 290_000_000);
    assert_eq!(smallest(&limits_of(&SystemFiles::default()), 1), None);
}

#[test]
fn lines_of_proc_are_read_and_others_give_nothing() {
    assert_eq!(kibibytes(MEMINFO, "MemTotal"), Some(24_684_364 << 10));
    assert_eq!(kibibytes(MEMINFO, "Mem"), None);
    assert_eq!(kibibytes("MemTotal: 5 MB", "MemTotal"), None);
    assert_eq!(kibibytes("MemTotal: 99999999999999999999 kB", "MemTotal"), None);
    assert_eq!(address_space_limit(LIMITS), Some(716_800_000));
    assert_eq!(address_space_limit("Max address space unlimited unlimited bytes"), None);
}

#[test]
fn a_group_without_a_limit_gives_none_and_file_contents_are_not_in_use() {
    let v1 = |limit: &str| ControlGroups::V1.group([limit, "5000\n", "total_inactive_file 2000\n"]);
    assert_eq!(v1("9223372036854771712\n"), None);
    assert_eq!(v1("7000\n"), Some(Group { limit: 7000, used: 3000 }));
    let v2 =
        |limit: &str| ControlGroups::V2.group([limit, "5000\n", "anon 1\ninactive_file 1000\n"]);
    assert_eq!(v2("max\n"), None);
    assert_eq!(v2("7000\n"), Some(Group { limit: 7000, used: 4000 }));
    assert_eq!(ControlGroups::V2.group(["", "", ""]), None);
}

#[test]
fn every_group_up_to_the_root_of_the_mount_counts() {
    let folders = |cgroup: &str, mounts: &str| -> Vec<PathBuf> {
        group_folders(cgroup, mounts).into_iter().map(|(_, folder)| folder).collect()
    };
    let v2 = "30 23 0:26 / /sys/fs/cgroup rw,nosuid shared:4 - cgroup2 cgroup2 rw,nsdelegate\n";
    let paths =
        ["/sys/fs/cgroup/user.slice/a.scope", "/sys/fs/cgroup/user.slice", "/sys/fs/cgroup"];
    assert_eq!(folders("0::/user.slice/a.scope\n", v2), paths.map(PathBuf::from));
    let v1 = "35 31 0:32 / /sys/fs/cgroup/memory rw,relatime - cgroup cgroup rw,memory\n\
              36 31 0:33 / /sys/fs/cgroup/cpu rw,relatime - cgroup cgroup rw,cpu\n";
    let paths = ["/sys/fs/cgroup/memory/job", "/sys/fs/cgroup/memory"];
    assert_eq!(folders("5:cpu:/x\n4:memory:/job\n0::/\n", v1), paths.map(PathBuf::from));
    // A container that mounts its own group, and names the path of the host.
    let container = "35 31 0:32 /docker/abc /sys/fs/cgroup/memory ro - cgroup cgroup rw,memory\n";
    let paths = ["/sys/fs/cgroup/memory"];
    assert_eq!(folders("4:memory:/docker/abc\n", container), paths.map(PathBuf::from));
    assert_eq!(folders("4:memory:/other\n", container), paths.map(PathBuf::from));
    assert!(folders("", v2).is_empty() && folders("0::/a\n", "").is_empty());
}

#[test]
fn threads_leave_half_of_a_small_address_space_to_jobs() {
    let limit = |total| Limit { kind: LimitKind::AddressSpace, total, free: total };
    assert_eq!(limit(700 << 20).threads(16), 3);
    assert_eq!(limit(64 << 30).threads(16), 16);
    assert_eq!(limit(100 << 20).threads(16), 1);
    assert_eq!(limit(100 << 20).usable(1), 0);
    assert_eq!(limit(100 << 20).usable_alone(), 10 << 20);
}

#[test]
fn sizes_have_two_digits() {
    for (bytes, text) in [
        (800, "0.8 kB"),
        (716_800_000, "717 MB"),
        (1_700_000_000, "1.7 GB"),
        (9_990_000, "10 MB"),
        (16_000_000_000, "16 GB"),
    ] {
        assert_eq!(size(bytes), text);
    }
}
