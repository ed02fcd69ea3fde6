// The system interface of a WebAssembly module (WASI preview 1), with files in memory, of which there is one folder of all: "/".

const ERRNO = { success: 0, badf: 8, exist: 20, inval: 28, isdir: 31, noent: 44, notdir: 54 };
const [CHARACTERS, FOLDER, FILE] = [2, 3, 4];
const ROOT_FD = 3;
const ALL_RIGHTS = 0xffff_ffff_ffff_ffffn;

/** Files in memory, by their paths without the first "/"; a folder is one of `null`. */
class Files {
  constructor() {
    this.entries = new Map([["", null]]);
    /** Whether a file appears that is in nobody's memory; `undefined` for other paths. */
    this.appears = () => undefined;
  }

  static resolve(base, path) {
    const parts = [];
    for (const part of `${base}/${path}`.split("/")) {
      if (part === "..") parts.pop();
      else if (part && part !== ".") parts.push(part);
    }
    return parts.join("/");
  }

  /** Puts a file where it belongs, with its folders. */
  put(path, bytes) {
    const parts = Files.resolve("", path).split("/");
    for (let i = 1; i < parts.length; i += 1) this.entries.set(parts.slice(0, i).join("/"), null);
    this.entries.set(parts.join("/"), { bytes, length: bytes?.length, changed: Date.now() });
  }

  /** Puts a file whose bytes come from the server when they are asked for. */
  putLater(path) {
    this.put(path, null);
  }

  /** A file, or `null` for a folder; `undefined` if there is neither. */
  at(path) {
    const file = this.entries.get(path);
    if (file && !file.bytes) {
      const get = new XMLHttpRequest();
      get.open("GET", path, false);
      get.responseType = "arraybuffer";
      get.send();
      if (get.status !== 200) throw new Error(`${path} is missing on the server (${get.status})`);
      file.bytes = new Uint8Array(get.response);
      file.length = file.bytes.length;
    }
    return file;
  }

  /** The bytes of a file. */
  bytes(path) {
    const file = this.at(Files.resolve("", path));
    return file?.bytes.slice(0, file.length);
  }

  folderOf(path) {
    return path.includes("/") ? path.slice(0, path.lastIndexOf("/")) : "";
  }

  /** The names in a folder, with what they name. */
  list(folder) {
    const within = folder ? `${folder}/` : "";
    const all = [...this.entries].filter(([path]) => path && this.folderOf(path) === folder);
    return all.map(([path, file]) => [path.slice(within.length), file]);
  }
}

/** Appends or overwrites bytes of a file. */
function writeAt(file, at, bytes) {
  const end = at + bytes.length;
  if (end > file.bytes.length) {
    const grown = new Uint8Array(Math.max(end, 2 * file.bytes.length));
    grown.set(file.bytes.subarray(0, file.length));
    file.bytes = grown;
  }
  file.bytes.set(bytes, at);
  file.length = Math.max(file.length, end);
  file.changed = Date.now();
}

/** The imports of a module, its files, and `onLine`, which gets every line of its output and whether it is an error. */
function wasi(files, onLine) {
  let memory;
  const fds = new Map([[ROOT_FD, { path: "", folder: true }]]);
  let nextFd = ROOT_FD + 1;
  const unfinished = ["", "", ""];
  const decoders = [null, new TextDecoder(), new TextDecoder()];
  const view = () => new DataView(memory.buffer);
  const slice = (at, length) => new Uint8Array(memory.buffer, at, length);
  const text = (at, length) => new TextDecoder().decode(slice(at, length));
  const pathAt = (fd, at, length) => Files.resolve(fds.get(fd)?.path ?? "", text(at, length));
  const inode = (path) => BigInt([...path].reduce((hash, c) => (hash * 31 + c.charCodeAt(0)) % 2 ** 48, 7));

  const fdstat = (at, kind) => {
    view().setUint8(at, kind);
    view().setUint16(at + 2, 0, true);
    view().setBigUint64(at + 8, ALL_RIGHTS, true);
    view().setBigUint64(at + 16, ALL_RIGHTS, true);
  };
  const filestat = (at, path, file) => {
    const changed = BigInt(file?.changed ?? 0) * 1_000_000n;
    const values = [0n, inode(path), BigInt(file ? FILE : FOLDER), 1n, BigInt(file?.length ?? 0), changed, changed, changed];
    values.forEach((value, i) => view().setBigUint64(at + 8 * i, value, true));
  };
  const buffers = (at, count) => Array.from({ length: count }, (_, i) => {
    const place = view();
    return slice(place.getUint32(at + 8 * i, true), place.getUint32(at + 8 * i + 4, true));
  });

  const calls = {
    environ_sizes_get(count, size) { view().setUint32(count, 0, true); view().setUint32(size, 0, true); },
    environ_get() {},
    clock_time_get(clock, _precision, at) {
      const ms = clock === 0 ? Date.now() : performance.now();
      view().setBigUint64(at, BigInt(Math.round(ms * 1e6)), true);
    },
    random_get(at, length) {
      for (let i = 0; i < length; i += 65536) crypto.getRandomValues(slice(at + i, Math.min(65536, length - i)));
    },
    sched_yield() {},
    proc_exit(code) { throw new Error(`the program ended with ${code}`); },
    fd_prestat_get(fd, at) {
      if (fd !== ROOT_FD) return ERRNO.badf;
      view().setUint32(at, 0, true);
      view().setUint32(at + 4, 1, true);
    },
    fd_prestat_dir_name(_fd, at) { slice(at, 1)[0] = "/".charCodeAt(0); },
    fd_fdstat_get(fd, at) {
      if (fd < ROOT_FD) return fdstat(at, CHARACTERS);
      const open = fds.get(fd);
      return open ? fdstat(at, open.folder ? FOLDER : FILE) : ERRNO.badf;
    },
    fd_filestat_get(fd, at) {
      const open = fds.get(fd);
      return open ? filestat(at, open.path, open.file) : ERRNO.badf;
    },
    fd_sync() {},
    fd_close(fd) { return fds.delete(fd) ? ERRNO.success : ERRNO.badf; },
    fd_read(fd, at, count, read) {
      const open = fds.get(fd);
      if (!open?.file) return open ? ERRNO.isdir : ERRNO.badf;
      let total = 0;
      for (const buffer of buffers(at, count)) {
        const bytes = open.file.bytes.subarray(open.at, Math.min(open.at + buffer.length, open.file.length));
        buffer.set(bytes);
        open.at += bytes.length;
        total += bytes.length;
      }
      view().setUint32(read, total, true);
    },
    fd_write(fd, at, count, written) {
      let total = 0;
      for (const buffer of buffers(at, count)) {
        total += buffer.length;
        if (fd < ROOT_FD) {
          unfinished[fd] += decoders[fd].decode(buffer, { stream: true });
          continue;
        }
        const open = fds.get(fd);
        if (!open?.file) return ERRNO.badf;
        if (open.appends) open.at = open.file.length;
        writeAt(open.file, open.at, buffer);
        open.at += buffer.length;
      }
      view().setUint32(written, total, true);
      if (fd < ROOT_FD && unfinished[fd].includes("\n")) {
        const lines = unfinished[fd].split("\n");
        unfinished[fd] = lines.pop();
        lines.forEach((line) => onLine(line, fd === 2));
      }
    },
    fd_readdir(fd, at, length, cookie, used) {
      const open = fds.get(fd);
      if (!open?.folder) return ERRNO.notdir;
      const out = slice(at, length);
      let end = 0;
      // What is removed between two calls moves nothing.
      open.listed ??= files.list(open.path);
      open.listed.slice(Number(cookie)).forEach(([name, file], i) => {
        const encoded = new TextEncoder().encode(name);
        const entry = new Uint8Array(24 + encoded.length);
        const fields = new DataView(entry.buffer);
        fields.setBigUint64(0, cookie + BigInt(i + 1), true);
        fields.setBigUint64(8, inode(`${open.path}/${name}`), true);
        fields.setUint32(16, encoded.length, true);
        fields.setUint8(20, file ? FILE : FOLDER);
        entry.set(encoded, 24);
        const fits = entry.subarray(0, Math.max(0, length - end));
        out.set(fits, end);
        end += fits.length;
      });
      view().setUint32(used, end, true);
    },
    path_open(fd, _follow, at, length, flags, _rights, _inherited, options, opened) {
      const [create, directory, exclusive, truncate] = [1, 2, 4, 8].map((flag) => (flags & flag) !== 0);
      const path = pathAt(fd, at, length);
      const exists = files.entries.has(path);
      if (!exists && !create) return ERRNO.noent;
      if (exists && exclusive) return ERRNO.exist;
      if (!exists) {
        if (files.entries.get(files.folderOf(path)) !== null) return ERRNO.noent;
        files.put(path, new Uint8Array(0));
      }
      const file = files.at(path);
      if (directory && file) return ERRNO.notdir;
      if (truncate && file) file.length = 0;
      fds.set(nextFd, { path, file, folder: !file, at: 0, appends: (options & 1) !== 0 });
      view().setUint32(opened, nextFd, true);
      nextFd += 1;
    },
    path_filestat_get(fd, _follow, at, length, into) {
      const path = pathAt(fd, at, length);
      const exists = files.appears(path) ?? files.entries.has(path);
      return exists ? filestat(into, path, files.entries.get(path)) : ERRNO.noent;
    },
    path_create_directory(fd, at, length) {
      const path = pathAt(fd, at, length);
      if (files.entries.has(path)) return ERRNO.exist;
      if (files.entries.get(files.folderOf(path)) !== null) return ERRNO.noent;
      files.entries.set(path, null);
    },
    path_rename(fd, at, length, toFd, toAt, toLength) {
      const [from, to] = [pathAt(fd, at, length), pathAt(toFd, toAt, toLength)];
      if (!files.entries.has(from)) return ERRNO.noent;
      for (const [path, file] of [...files.entries]) {
        if (path !== from && !path.startsWith(`${from}/`)) continue;
        files.entries.delete(path);
        files.entries.set(to + path.slice(from.length), file);
      }
    },
    path_remove_directory(fd, at, length) { return calls.path_unlink_file(fd, at, length); },
    path_unlink_file(fd, at, length) { return files.entries.delete(pathAt(fd, at, length)) ? ERRNO.success : ERRNO.noent; },
    path_readlink() { return ERRNO.inval; },
  };
  const answered = Object.entries(calls).map(([name, call]) => [name, (...given) => call(...given) ?? ERRNO.success]);
  return {
    imports: { wasi_snapshot_preview1: Object.fromEntries(answered) },
    begin: (instance) => { memory = instance.exports.memory; },
  };
}
