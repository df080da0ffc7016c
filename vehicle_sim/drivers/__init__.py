"""What brings a swarm to life: sockets, clocks, and the end of it all."""
