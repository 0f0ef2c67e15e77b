// A stand-in for oneTBB in builds with the thread sanitizer.
//
// The sanitizer sees only what is compiled with it. The oneTBB of a distribution is not, so it
// would take what a thread hands over to another for a race. These are the parts that the project
// uses, on threads of the standard library, small rather than fast. Work within work is done in
// order by the thread that asks for it, but for task groups.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace tbb {

// -- how many threads ----------------------------------------------------------------------------

namespace info {
// Two at least, or there would be nothing to see.
inline int default_concurrency() {
    return std::max(2, static_cast<int>(std::thread::hardware_concurrency()));
}
}  // namespace info

namespace stand_in {

inline int& concurrency() {
    thread_local int n = info::default_concurrency();
    return n;
}

inline bool& is_at_work() {
    thread_local bool at_work = false;
    return at_work;
}

/// The threads, which wait for the next job. Only one job at a time.
class Pool {
public:
    static Pool& only() {
        static Pool pool;
        return pool;
    }
    ~Pool() {
        {
            const std::lock_guard lock(mutex_);
            is_over_ = true;
        }
        begun_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }

    /// work() on so many threads, of which the calling one is one. Passes on what is thrown.
    void run(int n, const std::function<void()>& work) {
        const std::unique_lock busy(busy_, std::try_to_lock);
        if (n < 2 || is_at_work() || !busy) return work();
        {
            const std::lock_guard lock(mutex_);
            while (static_cast<int>(threads_.size()) < n - 1)
                threads_.emplace_back([this, first = jobs_] { wait(first); });
            work_ = &work;
            limit_ = concurrency();
            open_ = n - 1;
            ++jobs_;
        }
        begun_.notify_all();
        take(work);
        std::unique_lock lock(mutex_);
        open_ = 0;  // who has not come by now need not come
        ended_.wait(lock, [&] { return working_ == 0; });
        if (const std::exception_ptr thrown = std::exchange(thrown_, nullptr))
            std::rethrow_exception(thrown);
    }

private:
    void take(const std::function<void()>& work) {
        is_at_work() = true;
        try {
            work();
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (thrown_ == nullptr) thrown_ = std::current_exception();
        }
        is_at_work() = false;
    }

    void wait(std::size_t seen) {
        std::unique_lock lock(mutex_);
        for (;;) {
            begun_.wait(lock, [&] { return is_over_ || (jobs_ != seen && open_ > 0); });
            if (is_over_) return;
            seen = jobs_;
            --open_;
            ++working_;
            concurrency() = limit_;
            const std::function<void()>& work = *work_;
            lock.unlock();
            take(work);
            lock.lock();
            --working_;
            ended_.notify_all();
        }
    }

    std::mutex busy_, mutex_;
    std::condition_variable begun_, ended_;
    std::vector<std::thread> threads_;
    const std::function<void()>* work_ = nullptr;
    std::exception_ptr thrown_;
    std::size_t jobs_ = 0;
    int limit_ = 0, open_ = 0, working_ = 0;
    bool is_over_ = false;
};

/// body(i) for i = 0 .. n-1, in any order.
template <class Body>
void for_each(std::size_t n, const Body& body) {
    std::atomic<std::size_t> next{0};
    const int threads = static_cast<int>(
        std::min<std::size_t>(n, static_cast<std::size_t>(std::max(1, concurrency()))));
    Pool::only().run(threads, [&] {
        for (std::size_t i = next++; i < n; i = next++) body(i);
    });
}

}  // namespace stand_in

class task_arena {
public:
    explicit task_arena(int threads) : threads_(threads) {}
    template <class Work>
    auto execute(const Work& work) {
        struct Restore {
            int before = stand_in::concurrency();
            ~Restore() { stand_in::concurrency() = before; }
        } const restore;
        stand_in::concurrency() = threads_;
        return work();
    }

private:
    int threads_;
};

namespace this_task_arena {
inline int max_concurrency() { return stand_in::concurrency(); }
}  // namespace this_task_arena

struct global_control {
    enum parameter { max_allowed_parallelism };
    global_control(parameter, std::size_t) {}
    ~global_control() {}  // a variable of this type is used, then
};

// -- loops ---------------------------------------------------------------------------------------

template <class T>
class blocked_range {
public:
    using const_iterator = T;
    blocked_range(T begin, T end, std::size_t grain = 1)
        : begin_(begin), end_(std::max(begin, end)), grain_(grain) {}
    [[nodiscard]] T begin() const { return begin_; }
    [[nodiscard]] T end() const { return end_; }
    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
    [[nodiscard]] bool empty() const { return size() == 0; }

    /// Pieces of the grain's size at least; some for each thread.
    [[nodiscard]] std::vector<blocked_range> pieces() const {
        const auto threads = static_cast<std::size_t>(std::max(1, stand_in::concurrency()));
        const std::size_t length = std::max(grain_, size() / (8 * threads) + 1);
        std::vector<blocked_range> out;
        for (std::size_t at = 0; at < size(); at += length)
            out.emplace_back(static_cast<T>(begin_ + static_cast<T>(at)),
                             static_cast<T>(begin_ + static_cast<T>(std::min(size(), at + length))),
                             grain_);
        return out;
    }

private:
    T begin_, end_;
    std::size_t grain_;
};

template <class T, class Body>
void parallel_for(const blocked_range<T>& range, const Body& body) {
    const auto pieces = range.pieces();
    stand_in::for_each(pieces.size(), [&](std::size_t i) { body(pieces[i]); });
}

template <class First, class Last, class Body>
requires std::is_integral_v<First>
void parallel_for(First first, Last last, const Body& body) {
    using T = std::common_type_t<First, Last>;
    parallel_for(blocked_range<T>(first, last), [&](const blocked_range<T>& range) {
        for (T i = range.begin(); i != range.end(); ++i) body(i);
    });
}

template <class T, class Value, class Body, class Join>
Value parallel_reduce(const blocked_range<T>& range, const Value& identity, const Body& body,
                      const Join& join) {
    const auto pieces = range.pieces();
    std::vector<Value> parts(pieces.size(), identity);
    stand_in::for_each(pieces.size(), [&](std::size_t i) { parts[i] = body(pieces[i], identity); });
    Value sum = identity;
    for (const Value& part : parts) sum = join(sum, part);
    return sum;
}

template <class A, class B>
void parallel_invoke(const A& a, const B& b) {
    stand_in::for_each(2, [&](std::size_t i) { i == 0 ? a() : b(); });
}

template <class Iterator, class Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = {}) {
    std::sort(begin, end, less);
}
template <class Range>
void parallel_sort(Range& range) {
    std::sort(range.begin(), range.end());
}
template <class Range, class Less>
requires requires(Range& range) { range.begin(); }
void parallel_sort(Range& range, const Less& less) { std::sort(range.begin(), range.end(), less); }

// -- values of threads ---------------------------------------------------------------------------

template <class T>
class enumerable_thread_specific {
public:
    enumerable_thread_specific() requires std::is_default_constructible_v<T>
        : make_([](std::list<T>& to) -> T& { return to.emplace_back(); }) {}
    template <class Make>
    requires std::is_invocable_r_v<T, Make>
    explicit enumerable_thread_specific(Make make)
        : make_([make = std::move(make)](std::list<T>& to) -> T& {
              return to.emplace_back(make());
          }) {}

    T& local() {
        const std::lock_guard lock(held_->mutex);
        T*& mine = held_->of_thread[std::this_thread::get_id()];
        if (mine == nullptr) mine = &make_(held_->values);
        return *mine;
    }
    auto begin() { return held_->values.begin(); }
    auto end() { return held_->values.end(); }

private:
    /// Apart, so that the whole can be moved.
    struct Held {
        std::mutex mutex;
        std::list<T> values;
        std::map<std::thread::id, T*> of_thread;
    };

    std::function<T&(std::list<T>&)> make_;
    std::unique_ptr<Held> held_ = std::make_unique<Held>();
};

// -- tasks ---------------------------------------------------------------------------------------

/// A task gets a thread of its own while there are few, and else that of whoever runs it.
class task_group {
public:
    template <class Work>
    void run(const Work& work) {
        const std::unique_lock lock(mutex_);
        waiting_.emplace_back(work);
    }
    /// Until all are done, those too that tasks have run. Passes on what is thrown.
    void wait() {
        stand_in::Pool::only().run(stand_in::concurrency(), [&] {
            while (take_one()) {
            }
        });
    }

private:
    bool take_one() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return !waiting_.empty() || working_ == 0; });
        if (waiting_.empty()) return false;
        const std::function<void()> work = std::move(waiting_.front());
        waiting_.pop_front();
        ++working_;
        lock.unlock();
        std::exception_ptr thrown;
        try {
            work();
        } catch (...) {
            thrown = std::current_exception();
        }
        lock.lock();
        --working_;
        lock.unlock();
        changed_.notify_all();
        if (thrown != nullptr) std::rethrow_exception(thrown);
        return true;
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::list<std::function<void()>> waiting_;
    int working_ = 0;
};

// -- pipelines -----------------------------------------------------------------------------------

class flow_control {
public:
    void stop() { is_over_ = true; }
    [[nodiscard]] bool is_over() const { return is_over_; }

private:
    bool is_over_ = false;
};

enum class filter_mode { serial_in_order, parallel };

template <class In, class Out, class Work>
struct Filter {
    Work work;
};
template <class In, class Out, class Work>
Filter<In, Out, Work> make_filter(filter_mode, const Work& work) {
    return {work};
}

template <class A, class B>
struct Chain {
    A first;
    B rest;
};
template <class I, class M, class O, class A, class B>
auto operator&(const Filter<I, M, A>& a, const Filter<M, O, B>& b) {
    return Chain<Filter<I, M, A>, Filter<M, O, B>>{a, b};
}
template <class I, class M, class N, class O, class A, class B, class C>
auto operator&(const Chain<Filter<I, M, A>, Filter<M, N, B>>& a, const Filter<N, O, C>& b) {
    return Chain<Chain<Filter<I, M, A>, Filter<M, N, B>>, Filter<N, O, C>>{a, b};
}

/// One that reads, one that works in parallel and one that writes: as many items at a time as may
/// be in flight.
template <class M, class N, class A, class B, class C>
void parallel_pipeline(
    std::size_t in_flight,
    const Chain<Chain<Filter<void, M, A>, Filter<M, N, B>>, Filter<N, void, C>>& chain) {
    flow_control control;
    while (!control.is_over()) {
        std::vector<M> items;
        while (items.size() < in_flight) {
            M item = chain.first.first.work(control);
            if (control.is_over()) break;
            items.push_back(std::move(item));
        }
        std::vector<std::optional<N>> made(items.size());
        stand_in::for_each(items.size(), [&](std::size_t i) {
            made[i].emplace(chain.first.rest.work(std::move(items[i])));
        });
        for (const std::optional<N>& item : made) chain.rest.work(*item);
    }
}

}  // namespace tbb
