// Replaces a function of Emscripten in the module. The function returns the limit of the module's memory in bytes,
// which the caller that makes a module may set. The largest possible limit is one page less than 4 GiB, because the
// module counts bytes in 32 bits.
mergeInto(LibraryManager.library, {
  emscripten_get_heap_max: function () {
    return Math.min(Module['memoryLimit'] || Infinity, 4294901760);
  },
});
