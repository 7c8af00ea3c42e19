// A vector for data of many megabytes: in huge pages where the system has them, and not set to
// zero.
//
// With pages of 4 KiB, filling gigabytes and reading them at random costs many faults and misses of
// the page tables. resize() leaves new elements of trivial types unset.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

#include <sys/mman.h>

namespace ql {

template<class T>
class HugePageAllocator {
  public:
    using value_type = T;

    HugePageAllocator() = default;
    template<class U>
    HugePageAllocator(const HugePageAllocator<U>&) {}

    T* allocate(size_t n) {
        if (n > (size_t{1} << 48) / sizeof(T)) throw std::bad_array_new_length();
        const size_t bytes = n * sizeof(T);
        if (bytes < kPage) return static_cast<T*>(::operator new(bytes));
        const size_t rounded = (bytes + kPage - 1) / kPage * kPage;
        void* const memory = std::aligned_alloc(kPage, rounded);
        if (!memory) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
        madvise(memory, rounded, MADV_HUGEPAGE); // a hint: no harm where it is not taken
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, size_t n) {
        n * sizeof(T) < kPage ? ::operator delete(memory) : std::free(memory);
    }
    template<class U>
    void construct(U* at) {
        ::new (static_cast<void*>(at)) U;
    }
    template<class U, class... Args>
    void construct(U* at, Args&&... args) {
        ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
    }
    bool operator==(const HugePageAllocator&) const = default;

  private:
    static constexpr size_t kPage = size_t{1} << 21;
};

template<class T>
using HugeVector = std::vector<T, HugePageAllocator<T>>;

} // namespace ql
